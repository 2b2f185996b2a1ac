// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/export/zip.h"

#include <zlib.h>

#include <cstdint>
#include <stdexcept>

#include "operator_console/export/little_endian.h"

namespace shoal::console {
namespace {

// What the entry before a file and the entry in the directory share, from "version needed" to the lengths of
// names.
std::string entry(const ExportedFile& file) {
  const auto crc = static_cast<uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(file.content.data()), file.content.size()));
  const auto size = static_cast<uint32_t>(file.content.size());
  std::string bytes;
  addLittleEndian(bytes, uint16_t{20});      // version 2.0
  addLittleEndian(bytes, uint16_t{0x0800});  // names are UTF-8
  addLittleEndian(bytes, uint16_t{0});       // stored
  addLittleEndian(bytes, uint16_t{0});       // midnight
  addLittleEndian(bytes, uint16_t{0x0021});  // 1980-01-01
  addLittleEndian(bytes, crc);
  addLittleEndian(bytes, size);
  addLittleEndian(bytes, size);
  addLittleEndian(bytes, static_cast<uint16_t>(file.name.size()));
  addLittleEndian(bytes, uint16_t{0});  // no extra field
  return bytes;
}

}  // namespace

std::string zipOf(std::span<const ExportedFile> files) {
  uint64_t total = 0;
  for (const ExportedFile& file : files) total += file.content.size() + 2 * file.name.size() + 128;
  if (total > 0xffffffffu || files.size() > 0xffff)
    throw std::runtime_error("too much for one ZIP archive: over 4 GB");
  std::string zip, directory;
  for (const ExportedFile& file : files) {
    const std::string shared = entry(file);
    addLittleEndian(directory, uint32_t{0x02014b50});
    addLittleEndian(directory, uint16_t{20});
    directory += shared;
    addLittleEndian(directory, uint16_t{0});  // no comment
    addLittleEndian(directory, uint16_t{0});  // disk 0
    addLittleEndian(directory, uint16_t{0});  // internal attributes
    addLittleEndian(directory, uint32_t{0});  // external attributes
    addLittleEndian(directory, static_cast<uint32_t>(zip.size()));
    directory += file.name;
    addLittleEndian(zip, uint32_t{0x04034b50});
    zip += shared + file.name + file.content;
  }
  const auto at = static_cast<uint32_t>(zip.size());
  zip += directory;
  addLittleEndian(zip, uint32_t{0x06054b50});
  addLittleEndian(zip, uint32_t{0});  // one disk
  addLittleEndian(zip, static_cast<uint16_t>(files.size()));
  addLittleEndian(zip, static_cast<uint16_t>(files.size()));
  addLittleEndian(zip, static_cast<uint32_t>(directory.size()));
  addLittleEndian(zip, at);
  addLittleEndian(zip, uint16_t{0});
  return zip;
}

}  // namespace shoal::console
