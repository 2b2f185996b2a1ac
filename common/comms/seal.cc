// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/seal.h"

#include <fcntl.h>
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "shoal/comms/channels.h"
#include "shoal/demand.h"

namespace shoal::comms {
namespace {

constexpr std::string_view kFileBegin = "shoal-key-1 ";
constexpr size_t kFileBytes = kFileBegin.size() + 2 * SealKey::kBytes + 1;
constexpr size_t kTagBytes = 8;

using Personal = std::array<uint8_t, crypto_generichash_blake2b_PERSONALBYTES>;
constexpr Personal kSealPersonal = {'S', 'h', 'o', 'a', 'l', ' ', 's', 'e', 'a', 'l', ' ', '1'};
constexpr Personal kIdPersonal = {'S', 'h', 'o', 'a', 'l', ' ', 'k', 'e', 'y', ' ', 'i', 'd'};

void startLibrary() { SHOAL_DEMAND(sodium_init() >= 0); }

std::array<uint8_t, 16> hashOf(const std::array<uint8_t, SealKey::kBytes>& secret, const Personal& personal,
                               std::span<const uint8_t> head, std::span<const uint8_t> body) {
  startLibrary();
  std::array<uint8_t, 16> hash{};
  crypto_generichash_blake2b_state state;
  crypto_generichash_blake2b_init_salt_personal(&state, secret.data(), secret.size(), hash.size(), nullptr,
                                                personal.data());
  crypto_generichash_blake2b_update(&state, head.data(), head.size());
  crypto_generichash_blake2b_update(&state, body.data(), body.size());
  crypto_generichash_blake2b_final(&state, hash.data(), hash.size());
  return hash;
}

void putBigEndian(uint8_t* at, uint32_t value) {
  for (size_t i = 0; i < 4; ++i) at[i] = static_cast<uint8_t>(value >> (24 - 8 * i));
}

uint32_t bigEndian(const uint8_t* at) {
  return uint32_t{at[0]} << 24 | uint32_t{at[1]} << 16 | uint32_t{at[2]} << 8 | uint32_t{at[3]};
}

// A file descriptor that closes itself.
struct File {
  int fd;
  ~File() {
    if (fd >= 0) close(fd);
  }
};

// Text that holds a key, and does not outlive its use.
struct KeyText {
  std::array<char, kFileBytes + 1> text{};  // one more, to see that a file is longer
  ~KeyText() { sodium_memzero(text.data(), text.size()); }
};

void checkOwner(const std::string& path, const struct stat& status) {
  if (!S_ISREG(status.st_mode)) throw std::invalid_argument("key file " + path + " is not a file");
  if (status.st_uid != geteuid() && status.st_uid != 0) {
    throw std::invalid_argument("key file " + path +
                                " belongs to another user; it should be yours or root's");
  }
  if ((status.st_mode & 077) != 0) {
    throw std::invalid_argument("key file " + path + " is open to other users; run: chmod 600 " + path);
  }
}

}  // namespace

SealKey::SealKey(const std::array<uint8_t, kBytes>& secret) : secret_(secret) { startLibrary(); }

SealKey::~SealKey() { sodium_memzero(secret_.data(), secret_.size()); }

SealKey SealKey::read(const std::string& path) {
  startLibrary();
  const File file{open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  struct stat status {};
  if (file.fd < 0 || fstat(file.fd, &status) != 0) {
    throw std::invalid_argument("key file " + path + " cannot be read: " + std::strerror(errno));
  }
  checkOwner(path, status);
  KeyText key;
  std::array<uint8_t, kBytes> secret{};
  const ssize_t got = ::read(file.fd, key.text.data(), key.text.size());
  const std::string_view text(key.text.data(), got < 0 ? 0 : static_cast<size_t>(got));
  size_t filled = 0;
  const bool is_key = text.size() == kFileBytes && text.starts_with(kFileBegin) && text.ends_with('\n') &&
                      sodium_hex2bin(secret.data(), secret.size(), text.data() + kFileBegin.size(),
                                     2 * kBytes, nullptr, &filled, nullptr) == 0 &&
                      filled == kBytes;
  if (!is_key) {
    throw std::invalid_argument(path + " is no key file; make one with: operator_console keygen FILE");
  }
  SealKey read(secret);
  sodium_memzero(secret.data(), secret.size());
  return read;
}

SealKey SealKey::make(const std::string& path) {
  startLibrary();
  std::array<uint8_t, kBytes> secret{};
  randombytes_buf(secret.data(), secret.size());
  KeyText key;
  std::ranges::copy(kFileBegin, key.text.begin());
  sodium_bin2hex(key.text.data() + kFileBegin.size(), 2 * kBytes + 1, secret.data(), secret.size());
  key.text[kFileBytes - 1] = '\n';
  const File file{open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600)};
  if (file.fd < 0 && errno == EEXIST) {
    throw std::invalid_argument(path + " exists; a key is never overwritten: name another file");
  }
  if (file.fd < 0) throw std::runtime_error("cannot write " + path + ": " + std::strerror(errno));
  const ssize_t put = write(file.fd, key.text.data(), kFileBytes);
  if (put != static_cast<ssize_t>(kFileBytes) || fsync(file.fd) != 0) {
    const std::string why = std::strerror(errno);
    unlink(path.c_str());
    throw std::runtime_error("cannot write " + path + ": " + why);
  }
  SealKey made(secret);
  sodium_memzero(secret.data(), secret.size());
  return made;
}

std::string SealKey::id() const {
  const auto hash = hashOf(secret_, kIdPersonal, {}, {});
  std::array<char, 9> text{};
  sodium_bin2hex(text.data(), text.size(), hash.data(), 4);
  return text.data();
}

std::array<uint8_t, 8> SealKey::tag(std::string_view channel, uint32_t session, uint32_t counter,
                                    std::span<const uint8_t> message) const {
  SHOAL_DEMAND(channel.size() <= kMaxChannelLength);
  std::array<uint8_t, 1 + kMaxChannelLength + 8> head{};
  head[0] = static_cast<uint8_t>(channel.size());
  std::ranges::copy(channel, head.begin() + 1);
  putBigEndian(head.data() + 1 + channel.size(), session);
  putBigEndian(head.data() + 5 + channel.size(), counter);
  const auto hash = hashOf(secret_, kSealPersonal, std::span(head).first(9 + channel.size()), message);
  std::array<uint8_t, kTagBytes> tag{};
  std::copy_n(hash.begin(), tag.size(), tag.begin());
  return tag;
}

void addSeal(const SealKey& key, const Seal& seal, Packet& packet) {
  const auto tag = key.tag(packet.channel, seal.session, seal.counter, packet.bytes);
  const size_t size = packet.bytes.size();
  packet.bytes.resize(size + kSealBytes);
  putBigEndian(packet.bytes.data() + size, seal.session);
  putBigEndian(packet.bytes.data() + size + 4, seal.counter);
  std::ranges::copy(tag, packet.bytes.begin() + static_cast<std::ptrdiff_t>(size + 8));
}

std::optional<Seal> checkSeal(const SealKey& key, const Packet& packet) {
  if (packet.bytes.size() < kSealBytes || packet.channel.size() > kMaxChannelLength) return std::nullopt;
  const size_t size = packet.bytes.size() - kSealBytes;
  const uint8_t* at = packet.bytes.data() + size;
  const Seal seal{bigEndian(at), bigEndian(at + 4)};
  const auto tag = key.tag(packet.channel, seal.session, seal.counter, std::span(packet.bytes).first(size));
  if (sodium_memcmp(tag.data(), at + 8, tag.size()) != 0) return std::nullopt;
  return seal;
}

void removeSeal(Packet& packet) {
  SHOAL_DEMAND(packet.bytes.size() >= kSealBytes);
  packet.bytes.resize(packet.bytes.size() - kSealBytes);
  packet.trailer += kSealBytes;
}

}  // namespace shoal::comms
