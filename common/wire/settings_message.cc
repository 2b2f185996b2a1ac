// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/settings_message.h"

#include <cmath>
#include <shoal/settings_t.hpp>
#include <utility>

#include "shoal/wire/message.h"

namespace shoal::wire {

std::string faultOf(const mapping::SettingsPart& settings, const mapping::Piece& piece) {
  if (piece.key.kind != mapping::PieceKind::kSettings) return "key and content are of different kinds";
  if (piece.key.index != std::array<int32_t, 3>{}) return "the index of settings is {0, 0, 0}";
  if (piece.version.observation != 0) return "settings are of observation 0";
  if (piece.num_parts != 1) return "settings are one part";
  if (!std::isfinite(settings.cell_size_m) || !(settings.cell_size_m > 0))
    return "cell_size_m is not a length";
  return {};
}

Bytes encodeSettingsMessage(const mapping::Piece& piece, int32_t mission, world::Timestamp time) {
  const auto& settings = std::get<mapping::SettingsPart>(piece.content);
  settings_t message{};
  message.utime = time.us;
  message.mission = mission;
  message.robot = static_cast<int16_t>(number(piece.key.robot));
  message.epoch = piece.version.epoch;
  message.words = static_cast<int64_t>(settings.words);
  message.hyperparameters = static_cast<int64_t>(settings.hyperparameters);
  message.cell_size_m = settings.cell_size_m;
  return pack(std::move(message), {});
}

Result<mapping::Piece> decodeSettingsMessage(std::span<const uint8_t> bytes) {
  const auto message = unpack<settings_t>(bytes);
  if (!message) return message.error();
  const settings_t& m = *message;
  if (!m.payload.empty()) return DecodeError::kBadPayload;
  return mapping::pieceOf(
      world::RobotId{m.robot}, m.epoch,
      {static_cast<uint64_t>(m.words), static_cast<uint64_t>(m.hyperparameters), m.cell_size_m});
}

}  // namespace shoal::wire
