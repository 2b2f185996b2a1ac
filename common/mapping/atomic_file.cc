// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace shoal::mapping {
namespace {

[[noreturn]] void fail(const std::string& what, const std::string& path) {
  throw std::runtime_error(what + " " + path + ": " + std::strerror(errno));
}

}  // namespace

void writeFileAtomically(const std::string& path, std::string_view content) {
  writeFileAtomically(path, std::span(&content, 1));
}

void writeFileAtomically(const std::string& path, std::span<const std::string_view> contents) {
  const auto folder = std::filesystem::path(path).parent_path();
  std::error_code error;
  if (!folder.empty()) std::filesystem::create_directories(folder, error);
  const std::string temporary = path + ".tmp" + std::to_string(::getpid());
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) fail("cannot write", temporary);
  for (std::string_view rest : contents) {
    while (!rest.empty()) {
      const ssize_t n = ::write(file, rest.data(), rest.size());
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) {
        const int reason = errno;
        ::close(file);
        ::unlink(temporary.c_str());
        errno = reason;
        fail("cannot write", temporary);
      }
      rest.remove_prefix(static_cast<size_t>(n));
    }
  }
  ::fsync(file);
  ::close(file);
  if (::rename(temporary.c_str(), path.c_str()) != 0) fail("cannot rename to", path);
}

std::string readFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path)) {
    errno = std::filesystem::is_directory(path) ? EISDIR : errno;
    fail("cannot read", path);
  }
  std::ostringstream content;
  content << file.rdbuf();
  return std::move(content).str();
}

}  // namespace shoal::mapping
