// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/edit_message.h"

#include <shoal/edit_t.hpp>
#include <string>

#include "shoal/wire/message.h"

namespace shoal::wire {
namespace {

using mapping::Edit;
using mapping::TopicRef;

enum Operation : uint8_t { kName, kLink, kUnlink, kExclude, kUndo };

void put(Bytes& out, const std::string& text) {
  out.push_back(static_cast<uint8_t>(text.size()));
  out.insert(out.end(), text.begin(), text.end());
}

bool take(ByteReader& reader, std::string& text) {
  const auto bytes = reader.take(reader.bigEndian(1));
  text.assign(bytes.begin(), bytes.end());
  return !reader.failed();
}

void setTopic(edit_t& m, const TopicRef& topic) {
  m.robot = static_cast<int16_t>(number(topic.robot));
  m.epoch = topic.epoch;
  m.topic = static_cast<int16_t>(number(topic.topic));
}

TopicRef topicOf(const edit_t& m) { return {world::RobotId{m.robot}, m.epoch, world::TopicId{m.topic}}; }

}  // namespace

std::string faultOf(const Edit& edit, const mapping::Piece& piece) {
  if (std::string why = mapping::fault(edit); !why.empty()) return why;
  if (piece.key != mapping::keyOf(edit)) return "key and content are of different edits";
  if (piece.version != world::Version{} || piece.num_parts != 1)
    return "an edit is whole and of version (0, 0)";
  return {};
}

Bytes encodeEdit(const Edit& edit, int32_t mission, world::Timestamp time) {
  edit_t m{};
  m.utime = time.us;
  m.mission = mission;
  m.made = edit.time.us;
  m.counter = edit.id.counter;
  Bytes payload;
  put(payload, edit.id.author);
  if (const auto* name = std::get_if<mapping::NameEdit>(&edit.operation)) {
    m.operation = kName;
    setTopic(m, name->topic);
    put(payload, name->text);
  } else if (const auto* link = std::get_if<mapping::LinkEdit>(&edit.operation)) {
    m.operation = link->apart ? kUnlink : kLink;
    setTopic(m, link->a);
    m.other_robot = static_cast<int16_t>(number(link->b.robot));
    m.other_epoch = link->b.epoch;
    m.other_topic = static_cast<int16_t>(number(link->b.topic));
  } else if (const auto* exclude = std::get_if<mapping::ExcludeEdit>(&edit.operation)) {
    m.operation = kExclude;
    m.robot = static_cast<int16_t>(number(exclude->robot));
  } else {
    const mapping::EditId& undone = std::get<mapping::UndoEdit>(edit.operation).edit;
    m.operation = kUndo;
    m.undone = undone.counter;
    put(payload, undone.author);
  }
  return pack(std::move(m), std::move(payload));
}

Result<mapping::Piece> decodeEdit(std::span<const uint8_t> bytes) {
  const auto message = unpack<edit_t>(bytes);
  if (!message) return message.error();
  const edit_t& m = *message;
  if (m.operation > kUndo) return DecodeError::kBadField;
  Edit edit{.id = {.author = {}, .counter = m.counter}, .time = {m.made}, .operation = {}};
  ByteReader reader(m.payload);
  bool good = take(reader, edit.id.author);
  if (m.operation == kName) {
    mapping::NameEdit name{topicOf(m), {}};
    good = good && take(reader, name.text);
    edit.operation = std::move(name);
  } else if (m.operation == kLink || m.operation == kUnlink) {
    edit.operation =
        mapping::LinkEdit{topicOf(m),
                          {world::RobotId{m.other_robot}, m.other_epoch, world::TopicId{m.other_topic}},
                          m.operation == kUnlink};
  } else if (m.operation == kExclude) {
    edit.operation = mapping::ExcludeEdit{world::RobotId{m.robot}};
  } else {
    mapping::UndoEdit undo{{.author = {}, .counter = m.undone}};
    good = good && take(reader, undo.edit.author);
    edit.operation = std::move(undo);
  }
  if (!good || reader.remaining() != 0) return DecodeError::kBadPayload;
  return mapping::pieceOf(edit);
}

}  // namespace shoal::wire
