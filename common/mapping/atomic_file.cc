// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
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

// Gives the file up.
[[noreturn]] void failWithout(const std::string& temporary, const std::string& what,
                              const std::string& path) {
  const int reason = errno;
  ::unlink(temporary.c_str());
  errno = reason;
  fail(what, path);
}

// So that a rename outlives a loss of power. Some network file systems cannot: then nothing more can be done.
void syncFolder(const std::filesystem::path& folder) {
  const int opened = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (opened < 0) return;
  ::fsync(opened);
  ::close(opened);
}

// Writes everything. @returns whether it could; if not, errno says why.
bool write(int file, std::span<const std::string_view> contents) {
  for (std::string_view rest : contents) {
    while (!rest.empty()) {
      const ssize_t n = ::write(file, rest.data(), rest.size());
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) return false;
      rest.remove_prefix(static_cast<size_t>(n));
    }
  }
  return true;
}

// No name for a file of its own: /dev/null, a named pipe, /dev/stdout whatever that is.
bool isPlaceToWriteInto(const std::string& path) {
  for (const char* open_file : {"/dev/std", "/dev/fd/", "/proc/"})
    if (path.starts_with(open_file)) return true;
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
}

void writeInto(const std::string& path, std::span<const std::string_view> contents) {
  const int file = ::open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  if (file < 0) fail("cannot write into", path);
  const bool is_written = write(file, contents);
  const int reason = errno;
  const bool is_closed = ::close(file) == 0;
  if (!is_written) errno = reason;
  if (!is_written || !is_closed) fail("cannot write into", path);
}

}  // namespace

void makeFolder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw std::runtime_error("cannot make the folder " + folder + ": " + error.message());
  if (::access(folder.c_str(), W_OK | X_OK) != 0) fail("cannot write into", folder);
}

void writeFileAtomically(const std::string& path, std::string_view content) {
  writeFileAtomically(path, std::span(&content, 1));
}

void writeFileAtomically(const std::string& named, std::span<const std::string_view> contents) {
  if (isPlaceToWriteInto(named)) return writeInto(named, contents);
  std::error_code leads_nowhere;
  const bool is_link = std::filesystem::is_symlink(named, leads_nowhere);
  const std::string linked = is_link ? std::filesystem::canonical(named, leads_nowhere).string() : named;
  const std::string path = leads_nowhere ? named : linked;
  const auto folder = std::filesystem::path(path).parent_path();
  if (!folder.empty()) makeFolder(folder);
  const std::string temporary = path + ".tmp" + std::to_string(::getpid());
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) fail("cannot write", temporary);
  if (!write(file, contents)) {
    const int reason = errno;
    ::close(file);
    errno = reason;
    failWithout(temporary, "cannot write", temporary);
  }
  const bool is_synced = ::fsync(file) == 0;
  const int reason = errno;
  const bool is_closed = ::close(file) == 0;  // network file systems say only now that a disk is full
  if (!is_synced) errno = reason;
  if (!is_synced || !is_closed) failWithout(temporary, "cannot write", temporary);
  if (::rename(temporary.c_str(), path.c_str()) != 0) failWithout(temporary, "cannot rename to", path);
  syncFolder(folder);
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
