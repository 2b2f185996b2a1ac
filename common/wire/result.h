// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <variant>

#include "shoal/demand.h"

namespace shoal::wire {

/// Why a message was refused. A peer's bytes are never an exception: every refusal has a counter.
enum class DecodeError : uint8_t {
  kTooShort,       ///< shorter than its type's fixed fields
  kTooLong,        ///< longer than any message may be
  kWrongType,      ///< fingerprint of no type of ours, or of another type than the channel's
  kBadLength,      ///< the declared payload length is negative or more than came
  kTrailingBytes,  ///< more came than the declared length
  kUnknownFormat,  ///< payload of a version this build does not read
  kChecksum,       ///< damaged on the way
  kUndecodable,    ///< LCM's decoder refused it
  kBadField,       ///< a fixed field is out of range
  kBadPayload,     ///< the payload ends early, or holds something out of range
  kNotCanonical    ///< the value has another encoding: equal values must be equal bytes
};

inline constexpr std::array<std::string_view, 11> kDecodeErrorNames = {
    "too short", "too long",    "wrong type",         "bad length",  "trailing bytes", "unknown format",
    "checksum",  "undecodable", "field out of range", "bad payload", "not canonical"};
inline constexpr size_t kNumDecodeErrors = kDecodeErrorNames.size();

constexpr std::string_view name(DecodeError error) { return kDecodeErrorNames[static_cast<size_t>(error)]; }

/// A decoded value, or why there is none.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : outcome_(std::move(value)) {}  // NOLINT: implicit on purpose
  Result(DecodeError error) : outcome_(error) {}   // NOLINT

  bool ok() const { return outcome_.index() == 0; }
  explicit operator bool() const { return ok(); }

  /// Aborts when there is no value.
  const T& operator*() const& { return value(); }
  T&& operator*() && {
    SHOAL_DEMAND(ok());
    return std::move(std::get<0>(outcome_));
  }
  const T* operator->() const { return &value(); }

  /// Aborts when there is a value.
  DecodeError error() const {
    SHOAL_DEMAND(!ok());
    return std::get<1>(outcome_);
  }

 private:
  const T& value() const {
    SHOAL_DEMAND(ok());
    return std::get<0>(outcome_);
  }
  std::variant<T, DecodeError> outcome_;
};

}  // namespace shoal::wire
