// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/seal.h"

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "shoal/comms/replay_window.h"
#include "shoal/random.h"

namespace shoal::comms {
namespace {

SealKey keyFrom(uint8_t first) {
  std::array<uint8_t, SealKey::kBytes> secret{};
  std::iota(secret.begin(), secret.end(), first);
  return SealKey(secret);
}

const Packet kHello{"SHOAL_R03_TOPICS", {'h', 'e', 'l', 'l', 'o'}};

// By Python's hashlib: data = bytes([16]) + b"SHOAL_R03_TOPICS" + 01020304 00000007 + b"hello";
// blake2b(data, digest_size=16, key=bytes(range(32)), person=b"Shoal seal 1").digest()[:8]
TEST(SealTest, IsWhatAnotherImplementationMakes) {
  Packet packet = kHello;
  addSeal(keyFrom(0), {0x01020304, 7}, packet);
  EXPECT_EQ(packet.bytes, (Bytes{'h', 'e', 'l',  'l',  'o',  1,    2,    3,    4,    0,   0,
                                 0,   7,   0xcd, 0x9c, 0x75, 0x58, 0xda, 0x66, 0xa1, 0xc4}));
  EXPECT_EQ(keyFrom(0).id(), "2dfd3d8b");
}

TEST(SealTest, IsRightForTheKeyThatMadeItAndComesOff) {
  Packet packet = kHello;
  addSeal(keyFrom(0), {5, 9}, packet);
  const auto seal = checkSeal(keyFrom(0), packet);
  ASSERT_TRUE(seal.has_value());
  EXPECT_EQ(seal->session, 5u);
  EXPECT_EQ(seal->counter, 9u);
  EXPECT_FALSE(checkSeal(keyFrom(1), packet).has_value());
  const size_t size = wireSize(packet);
  removeSeal(packet);
  EXPECT_EQ(packet.bytes, kHello.bytes);
  EXPECT_EQ(wireSize(packet), size);
}

TEST(SealTest, NoBitCanBeFlippedAndNoByteCut) {
  Packet sealed{"SHOAL_R03_TOPICS", {}};
  for (int i = 0; i < 300; ++i) sealed.bytes.push_back(static_cast<uint8_t>(i));
  addSeal(keyFrom(0), {5, 9}, sealed);
  for (size_t bit = 0; bit < 8 * sealed.bytes.size(); ++bit) {
    Packet altered = sealed;
    altered.bytes[bit / 8] ^= static_cast<uint8_t>(1 << (bit % 8));
    EXPECT_FALSE(checkSeal(keyFrom(0), altered).has_value()) << bit;
  }
  for (size_t bit = 0; bit < 8 * sealed.channel.size(); ++bit) {
    Packet altered = sealed;
    altered.channel[bit / 8] = static_cast<char>(altered.channel[bit / 8] ^ 1 << (bit % 8));
    EXPECT_FALSE(checkSeal(keyFrom(0), altered).has_value()) << bit;
  }
  for (size_t size = 0; size < sealed.bytes.size(); ++size) {
    Packet cut{sealed.channel, Bytes(sealed.bytes.begin(), sealed.bytes.begin() + static_cast<long>(size))};
    EXPECT_FALSE(checkSeal(keyFrom(0), cut).has_value()) << size;
    Packet behead{sealed.channel, Bytes(sealed.bytes.end() - static_cast<long>(size), sealed.bytes.end())};
    EXPECT_FALSE(checkSeal(keyFrom(0), behead).has_value()) << size;
  }
  // Letters moved from the channel to the message: the channel's length is in the tag.
  Packet moved{"SHOAL_R03_TOPIC", sealed.bytes};
  moved.bytes.insert(moved.bytes.begin(), 'S');
  EXPECT_FALSE(checkSeal(keyFrom(0), moved).has_value());
}

// Against the definition: new when never seen and less than kWidth below the greatest.
TEST(ReplayWindowTest, IsWhatASetSays) {
  Random random(3);
  for (const uint64_t start : {uint64_t{0}, uint64_t{1} << 31, (uint64_t{1} << 32) - 9000}) {
    ReplayWindow window;
    std::set<uint64_t> seen;
    uint64_t at = start;
    for (int i = 0; i < 20000; ++i) {
      at = std::min<uint64_t>(at + random.below(i % 1000 == 0 ? 3000 : 3), UINT32_MAX);
      const uint64_t back = random.below(i % 50 == 0 ? 2500 : 12);
      const uint64_t counter = at - std::min(at, back);
      const bool is_new =
          seen.empty() || (!seen.contains(counter) && *seen.rbegin() < counter + ReplayWindow::kWidth);
      EXPECT_EQ(window.take(static_cast<uint32_t>(counter)), is_new) << counter;
      if (is_new) seen.insert(counter);
    }
  }
}

class KeyFileTest : public testing::Test {
 protected:
  KeyFileTest() { std::filesystem::create_directories(folder_); }
  ~KeyFileTest() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& text, mode_t mode = 0600) {
    const std::string path = folder_ + "/given.key";
    std::ofstream(path, std::ios::binary | std::ios::trunc) << text;
    chmod(path.c_str(), mode);
    return path;
  }
  // What reading says, "" when it is a key.
  static std::string refusal(const std::string& path) {
    try {
      SealKey::read(path);
      return "";
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
  }

  std::string folder_ = testing::TempDir() + "seal_test_" + std::to_string(getpid());
  std::string digits_ = "000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f";
};

TEST_F(KeyFileTest, IsMadeForItsOwnerAloneAndReadBack) {
  const std::string path = folder_ + "/team.key";
  const SealKey made = SealKey::make(path);
  struct stat status {};
  ASSERT_EQ(stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777, 0600u);
  EXPECT_EQ(SealKey::read(path).id(), made.id());
  EXPECT_NE(SealKey::make(folder_ + "/other.key").id(), made.id());
  EXPECT_THROW(SealKey::make(path), std::invalid_argument);  // never overwritten
  EXPECT_EQ(SealKey::read(path).id(), made.id());
  EXPECT_THROW(SealKey::make(folder_ + "/none/team.key"), std::runtime_error);
}

TEST_F(KeyFileTest, IsReadByItsDocumentedText) {
  EXPECT_EQ(SealKey::read(write("shoal-key-1 " + digits_ + "\n")).id(), keyFrom(0).id());
  EXPECT_EQ(refusal(write("shoal-key-1 " + digits_ + "\n", 0400)), "");
}

TEST_F(KeyFileTest, ThatOthersCanReadIsRefusedWithTheCommandThatHelps) {
  for (const mode_t mode : {0640, 0604, 0660, 0610, 0777}) {
    const std::string path = write("shoal-key-1 " + digits_ + "\n", mode);
    EXPECT_NE(refusal(path).find("chmod 600 " + path), std::string::npos) << mode;
  }
}

TEST_F(KeyFileTest, OfOtherContentIsRefusedAndNotTold) {
  for (const std::string& text :
       {std::string(), std::string("\n"), digits_ + "\n", "shoal-key-2 " + digits_ + "\n",
        "shoal-key-1 " + digits_, "shoal-key-1 " + digits_ + "\n\n", "shoal-key-1 " + digits_ + "00\n",
        "shoal-key-1 " + digits_.substr(2) + "\n", "shoal-key-1 " + digits_.substr(1) + "g\n",
        "shoal-key-1  " + digits_.substr(1) + "\n", std::string(100000, 'x')}) {
    const std::string said = refusal(write(text));
    EXPECT_NE(said.find("is no key file"), std::string::npos) << text.size();
    EXPECT_EQ(said.find(digits_.substr(10, 8)), std::string::npos);
  }
  EXPECT_NE(refusal(folder_ + "/none.key").find("cannot be read"), std::string::npos);
  EXPECT_NE(refusal(folder_).find("is not a file"), std::string::npos);
  EXPECT_NE(refusal("/dev/null").find("is not a file"), std::string::npos);
}

}  // namespace
}  // namespace shoal::comms
