// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/word_file.h"

#include <zstd.h>

#include <cstring>
#include <exception>
#include <string_view>
#include <type_traits>

#include "shoal/mapping/atomic_file.h"

namespace shoal::eval {
namespace {

constexpr uint64_t kMagic = 0x31736472'6f776873;  // "shwords1"
constexpr uint64_t kMostBytes = uint64_t{1} << 34;

// Numbers one after the other, in the machine's own order: a cache stays on its machine.
class Writer {
 public:
  template <typename T>
  void put(T value) {
    static_assert(std::is_integral_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void putCell(const world::CellIndex& c) {
    put(c.x);
    put(c.y);
    put(c.z);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}

  template <typename T>
  T get() {
    T value{};
    if (bytes_.size() < sizeof value) {
      good_ = false;
    } else {
      std::memcpy(&value, bytes_.data(), sizeof value);
      bytes_.remove_prefix(sizeof value);
    }
    return value;
  }
  world::CellIndex getCell() {
    const auto x = get<int32_t>(), y = get<int32_t>(), z = get<int32_t>();
    return {x, y, z};
  }
  // A count of things that take `size` bytes each at least: never more than there can be.
  size_t getCount(size_t size) {
    const auto count = get<uint64_t>();
    if (count > bytes_.size() / size) good_ = false;
    return good_ ? count : 0;
  }
  bool good() const { return good_; }
  bool atEnd() const { return good_ && bytes_.empty(); }

 private:
  std::string_view bytes_;
  bool good_ = true;
};

void write(const std::string& path, uint64_t key, const std::string& content) {
  std::string file(24 + ZSTD_compressBound(content.size()), '\0');
  ZSTD_CCtx* context = ZSTD_createCCtx();
  ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, 1);
  const size_t size =
      ZSTD_compress2(context, file.data() + 24, file.size() - 24, content.data(), content.size());
  ZSTD_freeCCtx(context);
  const uint64_t length = content.size();
  std::memcpy(file.data(), &kMagic, 8);
  std::memcpy(file.data() + 8, &key, 8);
  std::memcpy(file.data() + 16, &length, 8);
  file.resize(24 + size);
  mapping::writeFileAtomically(path, file);
}

std::optional<std::string> read(const std::string& path, uint64_t key) {
  std::string file;
  try {
    file = mapping::readFile(path);
  } catch (const std::exception&) {
    return std::nullopt;  // not there
  }
  uint64_t magic = 0, of = 0, length = 0;
  if (file.size() < 24) return std::nullopt;
  std::memcpy(&magic, file.data(), 8);
  std::memcpy(&of, file.data() + 8, 8);
  std::memcpy(&length, file.data() + 16, 8);
  if (magic != kMagic || of != key || length > kMostBytes) return std::nullopt;
  std::string content(length, '\0');
  const size_t size = ZSTD_decompress(content.data(), length, file.data() + 24, file.size() - 24);
  if (ZSTD_isError(size) || size != length) return std::nullopt;
  return content;
}

}  // namespace

void writeWordFile(const std::string& path, uint64_t key, const std::vector<world::WordsInCells>& images) {
  Writer writer;
  writer.put(uint64_t{images.size()});
  for (const world::WordsInCells& image : images) {
    writer.put(image.observation);
    writer.put(image.time.us);
    writer.put(image.dropped_words);
    writer.put(uint64_t{image.cells.size()});
    for (const world::CellWords& cell : image.cells) {
      writer.putCell(cell.cell);
      writer.put(uint64_t{cell.words.size()});
      for (const world::WordCount& w : cell.words) {
        writer.put(w.word);
        writer.put(w.count);
      }
    }
  }
  write(path, key, writer.bytes());
}

std::optional<std::vector<world::WordsInCells>> readWordFile(const std::string& path, uint64_t key) {
  const std::optional<std::string> content = read(path, key);
  if (!content) return std::nullopt;
  Reader reader(*content);
  std::vector<world::WordsInCells> images(reader.getCount(28));
  for (world::WordsInCells& image : images) {
    image.observation = reader.get<int32_t>();
    image.time.us = reader.get<int64_t>();
    image.dropped_words = reader.get<int64_t>();
    image.cells.resize(reader.getCount(20));
    for (world::CellWords& cell : image.cells) {
      cell.cell = reader.getCell();
      cell.words.resize(reader.getCount(8));
      for (world::WordCount& w : cell.words) {
        w.word = reader.get<int32_t>();
        w.count = reader.get<int32_t>();
      }
    }
  }
  if (!reader.atEnd()) return std::nullopt;
  return images;
}

void writeTruthFile(const std::string& path, uint64_t key, const CellTruth& truth) {
  Writer writer;
  writer.put(uint64_t{truth.size()});
  for (const auto& [cell, id] : truth) {
    writer.putCell(cell);
    writer.put(id);
  }
  write(path, key, writer.bytes());
}

std::optional<CellTruth> readTruthFile(const std::string& path, uint64_t key) {
  const std::optional<std::string> content = read(path, key);
  if (!content) return std::nullopt;
  Reader reader(*content);
  CellTruth truth(reader.getCount(13));
  for (auto& [cell, id] : truth) {
    cell = reader.getCell();
    id = reader.get<uint8_t>();
  }
  if (!reader.atEnd()) return std::nullopt;
  return truth;
}

}  // namespace shoal::eval
