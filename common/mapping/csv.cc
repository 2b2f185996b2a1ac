// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/csv.h"

#include <charconv>
#include <cmath>
#include <stdexcept>

namespace shoal::mapping {
namespace {

// One record starting at `begin`; moves `begin` past its line end.
std::vector<std::string> parseRecord(const std::string& text, size_t& begin) {
  std::vector<std::string> fields(1);
  bool in_quotes = false;
  for (; begin < text.size(); ++begin) {
    const char c = text[begin];
    if (in_quotes) {
      if (c != '"') {
        fields.back() += c;
      } else if (begin + 1 < text.size() && text[begin + 1] == '"') {
        fields.back() += '"';
        ++begin;
      } else {
        in_quotes = false;
      }
    } else if (c == '"') {
      in_quotes = true;
    } else if (c == ',') {
      fields.emplace_back();
    } else if (c == '\n') {
      ++begin;
      break;
    } else if (c != '\r') {
      fields.back() += c;
    }
  }
  return fields;
}

template <typename Number>
Number parse(const std::string& field, const std::string& path) {
  Number value{};
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc{} || end != field.data() + field.size()) {
    throw std::runtime_error(path + ": \"" + field + "\" is not a number");
  }
  return value;
}

}  // namespace

std::string fixed(double value, int decimals) {
  char buffer[64];
  const auto [end, error] =
      std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::fixed, decimals);
  std::string text = error == std::errc{} ? std::string(buffer, end) : std::to_string(value);
  if (text.starts_with('-') && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
  return text;
}

std::string quoted(std::string_view field) {
  if (field.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(field);
  std::string text = "\"";
  for (const char c : field) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + '"';
}

std::vector<std::vector<std::string>> parseCsv(const std::string& text,
                                               const std::vector<std::string>& columns,
                                               const std::string& path) {
  size_t at = 0;
  const std::vector<std::string> header = parseRecord(text, at);
  for (size_t i = 0; i < columns.size(); ++i) {
    if (i >= header.size() || header[i] != columns[i]) {
      throw std::runtime_error(path + ": column " + std::to_string(i + 1) + " should be \"" + columns[i] +
                               "\", is \"" + (i < header.size() ? header[i] : "") + "\"");
    }
  }
  std::vector<std::vector<std::string>> rows;
  for (int64_t line = 2; at < text.size(); ++line) {
    rows.push_back(parseRecord(text, at));
    if (rows.back().size() != header.size()) {
      throw std::runtime_error(path + " line " + std::to_string(line) + ": " +
                               std::to_string(rows.back().size()) + " fields, should be " +
                               std::to_string(header.size()));
    }
  }
  return rows;
}

double toReal(const std::string& field, const std::string& path) { return parse<double>(field, path); }
int64_t toInteger(const std::string& field, const std::string& path) { return parse<int64_t>(field, path); }

world::Timestamp timeFromSeconds(double seconds) { return {std::llround(seconds * 1e3) * 1000}; }

}  // namespace shoal::mapping
