# SPDX-License-Identifier: BSD-3-Clause
# cmake -DWEB=DIR -DDOCS=DIR -DOUT=FILE.cc -P embed.cmake: writes the files of the page as C++.
set(arrays "")
set(table "")
function(embed path source type)
  file(READ "${source}" hex HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
  string(MAKE_C_IDENTIFIER "file${path}" name)
  set(arrays "${arrays}constexpr unsigned char ${name}[] = {${bytes}0};\n" PARENT_SCOPE)
  set(table "${table}    {\"${path}\", {\"${type}\", text(${name}, sizeof ${name} - 1)}},\n" PARENT_SCOPE)
endfunction()
embed("/" "${WEB}/index.html" "text/html; charset=utf-8")
embed("/page.js" "${WEB}/dist/page.js" "text/javascript; charset=utf-8")
embed("/view3d.js" "${WEB}/dist/view3d.js" "text/javascript; charset=utf-8")
embed("/page.css" "${WEB}/dist/page.css" "text/css; charset=utf-8")
embed("/openapi.json" "${DOCS}/openapi.json" "application/json")
file(WRITE "${OUT}" "// Written by embed.cmake.
#include \"operator_console/serve/page_files.h\"

namespace shoal::console {
namespace {

${arrays}
struct Entry {
  std::string_view path;
  PageFile file;
};

std::string_view text(const unsigned char* bytes, size_t size) { return {reinterpret_cast<const char*>(bytes), size}; }

}  // namespace

const PageFile* pageFile(std::string_view path) {
  static const Entry files[] = {
${table}  };
  for (const Entry& entry : files)
    if (entry.path == path) return &entry.file;
  return nullptr;
}

}  // namespace shoal::console
")
