#include "sim/wire/can/axis_node.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace luxrig::sim {
namespace {

constexpr std::string_view kNodeName = "Simulated axis";
constexpr ObjectKey kNameObject{0x1008, 0};
constexpr std::uint32_t kPdoIsOff = 0x80000000;
constexpr std::size_t kMaxUnsent = 1000;

std::uint32_t word_in(const BusFrame& frame, std::size_t from, int bytes) {
  std::uint32_t value = 0;
  for (int i = 0; i < bytes; ++i)
    value |= static_cast<std::uint32_t>(frame.data[from + static_cast<std::size_t>(i)]) << (8 * i);
  return value;
}

std::uint8_t byte_of(std::uint32_t value, int i) { return static_cast<std::uint8_t>(value >> (8 * i)); }

}  // namespace

AxisNode::AxisNode(int node, const AxisTruth& truth, double angle_deg, std::uint32_t following_window)
    : node_(node), following_window_(following_window), drive_(truth, angle_deg) {}

void AxisNode::send(std::uint32_t id, std::initializer_list<std::uint8_t> payload) {
  if (sent_.size() < kMaxUnsent)
    sent_.push_back(bus_frame(id + static_cast<std::uint32_t>(node_), {payload.begin(), payload.size()}));
}

std::vector<BusFrame> AxisNode::take_sent() { return std::exchange(sent_, {}); }

void AxisNode::boot(Time now) {
  now_ = now;
  drive_.set_power(false);
  drive_.set_power(true);
  objects_ = std::make_unique<ObjectDictionary>([this](const ObjectKey& key) { return measured(key); });
  objects_->refuse_limits_in_pdos(limits_refused_);
  objects_->put({0x6065, 0}, following_window_);
  applied({0x6065, 0});
  for (int number = 0; number < 4; ++number) {  // the predefined connection set
    for (const int base : {0x1400, 0x1800})
      objects_->put({base + number, 1}, objects_->value({base + number, 1}) + static_cast<std::uint32_t>(node_));
    waiting_[number].reset();
    syncs_[number] = 0;
  }
  nmt_ = Nmt::pre_operational;
  master_heard_.reset();
  told_error_ = communication_error_ = 0;
  text_at_.reset();
  heartbeat_due_ = now;
  send(0x700, {0});
}

void AxisNode::refuse_limits_in_pdos(std::optional<std::uint32_t> abort_code) {
  limits_refused_ = abort_code;
  if (objects_) objects_->refuse_limits_in_pdos(abort_code);
}

void AxisNode::set_power(Time now, bool on) {
  if (on == powered_) return;
  powered_ = on;
  if (on) {
    boot(now);
  } else {
    drive_.set_power(false);
    sent_.clear();
  }
}

void AxisNode::reset(Time now) {
  if (powered_) boot(now);
}

std::uint32_t AxisNode::measured(const ObjectKey& key) const {
  switch (key.first) {
    case 0x1001:
      return drive_.error_code() != 0 || communication_error_ != 0 ? 1u : 0u;
    case 0x603F:
      return drive_.error_code() != 0 ? drive_.error_code() : communication_error_;
    case 0x6041:
      return drive_.statusword();
    case 0x6061:
      return static_cast<std::uint32_t>(drive_.mode_display()) & 0xFF;
    case 0x6064:
      return static_cast<std::uint32_t>(drive_.position());
    case 0x606C:
      return static_cast<std::uint32_t>(drive_.velocity());
    case 0x60FD:
      return drive_.digital_inputs();
    default:
      return 0;
  }
}

void AxisNode::applied(const ObjectKey& key) {
  const std::uint32_t value = objects_->value(key);
  DriveParameters& p = drive_.parameters;
  switch (key.first) {
    case 0x1016:
      master_heard_.reset();  // watched from the next heartbeat on
      break;
    case 0x1017:
      heartbeat_due_ = now_;
      break;
    case 0x6040:
      drive_.set_controlword(static_cast<std::uint16_t>(value));
      break;
    case 0x605A:
      p.quick_stop_option = static_cast<std::int16_t>(value);
      break;
    case 0x6060:
      p.mode = static_cast<std::int8_t>(value);
      break;
    case 0x6065:
      p.following_window = value;
      break;
    case 0x6066:
      p.following_time_ms = static_cast<std::uint16_t>(value);
      break;
    case 0x607A:
      p.target = static_cast<std::int32_t>(value);
      break;
    case 0x607C:
      p.home_offset = static_cast<std::int32_t>(value);
      break;
    case 0x607D:
      (key.second == 1 ? p.lowest : p.highest) = static_cast<std::int32_t>(value);
      break;
    case 0x6081:
      p.speed = value;
      break;
    case 0x6083:
      p.acceleration = value;
      break;
    case 0x6084:
      p.deceleration = value;
      break;
    case 0x6085:
      p.quick_stop_deceleration = value;
      break;
    case 0x6098:
      p.homing_method = static_cast<std::int8_t>(value);
      break;
    case 0x6099:
      (key.second == 1 ? p.homing_speed_switch : p.homing_speed_zero) = value;
      break;
    case 0x609A:
      p.homing_acceleration = value;
      break;
    default:
      break;
  }
}

void AxisNode::emergency(std::uint16_t code) {
  if (nmt_ == Nmt::stopped) return;
  send(0x080, {byte_of(code, 0), byte_of(code, 1), static_cast<std::uint8_t>(measured({0x1001, 0})), 0, 0, 0, 0, 0});
}

// --- time ---

void AxisNode::step(Time now, bool stuck) {
  now_ = now;
  drive_.step(stuck);
  if (!powered_) return;
  if (const std::uint32_t entry = objects_->value({0x1016, 1});
      master_heard_ && now - *master_heard_ > std::chrono::milliseconds(entry & 0xFFFF)) {
    master_heard_.reset();
    communication_error_ = 0x8130;
    emergency(communication_error_);
    if (objects_->value({0x1029, 1}) == 0) nmt_ = Nmt::pre_operational;
    if (objects_->value({0x1029, 1}) == 2) nmt_ = Nmt::stopped;
    drive_.abort_connection(static_cast<int>(objects_->value({0x6007, 0})));
  }
  if (const std::uint16_t error = drive_.error_code(); error != told_error_) {
    told_error_ = error;
    emergency(error);
  }
  const std::uint32_t period_ms = objects_->value({0x1017, 0});
  if (period_ms > 0 && now >= heartbeat_due_) {
    heartbeat_due_ = now + std::chrono::milliseconds(period_ms);
    send(0x700, {static_cast<std::uint8_t>(nmt_)});
  }
}

// --- frames ---

void AxisNode::receive(Time now, const BusFrame& frame) {
  if (!powered_) return;
  now_ = now;
  const auto node = static_cast<std::uint32_t>(node_);
  if (frame.id == 0) return take_nmt(now, frame);
  if (frame.id == 0x600 + node) {
    if (nmt_ != Nmt::stopped && frame.size == 8) take_sdo(frame);
    return;
  }
  const std::uint32_t consumer = objects_->value({0x1016, 1});
  if ((consumer & 0xFFFF) != 0 && frame.id == 0x700 + (consumer >> 16 & 0x7F)) {
    master_heard_ = now;
    if (std::exchange(communication_error_, std::uint16_t{0}) != 0) emergency(0);
    return;
  }
  if (nmt_ != Nmt::operational) return;
  if (frame.id == 0x080) return take_sync();
  for (int number = 0; number < 4; ++number) {
    if (frame.id != objects_->value({0x1400 + number, 1})) continue;  // off: its top bit is set
    if (objects_->value({0x1400 + number, 2}) <= 240) {
      waiting_[number] = frame;
    } else {
      apply_pdo(number, frame);
    }
  }
}

void AxisNode::take_nmt(Time now, const BusFrame& frame) {
  if (frame.size != 2 || (frame.data[1] != 0 && frame.data[1] != node_)) return;
  switch (frame.data[0]) {
    case 1:
      nmt_ = Nmt::operational;
      break;
    case 2:
      nmt_ = Nmt::stopped;
      break;
    case 0x80:
      nmt_ = Nmt::pre_operational;
      break;
    case 0x81:
    case 0x82:
      boot(now);
      break;
    default:
      break;
  }
}

void AxisNode::take_sync() {
  for (int number = 0; number < 4; ++number) {
    if (waiting_[number]) apply_pdo(number, *std::exchange(waiting_[number], std::nullopt));
  }
  for (int number = 0; number < 4; ++number) {
    const std::uint32_t every = objects_->value({0x1800 + number, 2});
    if ((objects_->value({0x1800 + number, 1}) & kPdoIsOff) != 0 || every == 0 || every > 240) continue;
    if (++syncs_[number] < static_cast<int>(every)) continue;
    syncs_[number] = 0;
    send_pdo(number);
  }
}

void AxisNode::apply_pdo(int number, const BusFrame& frame) {
  const auto count = static_cast<int>(objects_->value({0x1600 + number, 0}));
  std::size_t at = 0;
  std::vector<std::pair<ObjectKey, std::uint32_t>> values;
  for (int i = 1; i <= count; ++i) {
    const std::uint32_t entry = objects_->value({0x1600 + number, i});
    const auto bytes = static_cast<int>(entry & 0xFF) / 8;
    if (at + static_cast<std::size_t>(bytes) > frame.size) return emergency(0x8210);
    values.push_back({{static_cast<int>(entry >> 16), static_cast<int>(entry >> 8 & 0xFF)}, word_in(frame, at, bytes)});
    at += static_cast<std::size_t>(bytes);
  }
  // Numbers first: an action of the controlword must not start with old ones.
  std::stable_partition(values.begin(), values.end(), [](const auto& v) { return v.first.first != 0x6040; });
  for (const auto& [key, value] : values) {
    objects_->put(key, value);
    applied(key);
  }
}

void AxisNode::send_pdo(int number) {
  BusFrame frame{objects_->value({0x1800 + number, 1}), 0, {}};
  const auto count = static_cast<int>(objects_->value({0x1A00 + number, 0}));
  for (int i = 1; i <= count; ++i) {
    const std::uint32_t entry = objects_->value({0x1A00 + number, i});
    const std::uint32_t value = objects_->value({static_cast<int>(entry >> 16), static_cast<int>(entry >> 8 & 0xFF)});
    for (int b = 0; b < static_cast<int>(entry & 0xFF) / 8; ++b) frame.data[frame.size++] = byte_of(value, b);
  }
  if (sent_.size() < kMaxUnsent) sent_.push_back(frame);
}

// --- the SDO server ---

void AxisNode::abort_sdo(const ObjectKey& key, std::uint32_t code) {
  text_at_.reset();
  send(0x580,
       {0x80, static_cast<std::uint8_t>(key.first & 0xFF), static_cast<std::uint8_t>(key.first >> 8),
        static_cast<std::uint8_t>(key.second), byte_of(code, 0), byte_of(code, 1), byte_of(code, 2), byte_of(code, 3)});
}

void AxisNode::take_sdo(const BusFrame& frame) {
  const ObjectKey key{static_cast<int>(word_in(frame, 1, 2)), frame.data[3]};
  switch (frame.data[0] >> 5) {
    case 1:
      return download(frame, key);
    case 2:
      return upload(frame, key);
    case 3:
      return upload_segment(frame);
    case 4:  // the client gave up
      text_at_.reset();
      return;
    default:
      return abort_sdo(key, kUnknownCommand);
  }
}

void AxisNode::upload(const BusFrame& frame, const ObjectKey& key) {
  const DictionaryObject* object = objects_->find(key);
  if (object == nullptr) return abort_sdo(key, objects_->has_index(key.first) ? kNoSubIndex : kNoObject);
  const auto* address = &frame.data[1];
  if (key == kNameObject) {
    text_at_ = 0;
    toggle_ = false;
    send(0x580, {0x41, address[0], address[1], address[2], static_cast<std::uint8_t>(kNodeName.size()), 0, 0, 0});
    return;
  }
  const std::uint32_t value = objects_->value(key);
  const auto command = static_cast<std::uint8_t>(0x43 | (4 - object->bytes) << 2);
  const auto at = [&, bytes = object->bytes](int i) { return i < bytes ? byte_of(value, i) : std::uint8_t{0}; };
  send(0x580, {command, address[0], address[1], address[2], at(0), at(1), at(2), at(3)});
}

void AxisNode::upload_segment(const BusFrame& frame) {
  if (!text_at_) return abort_sdo(kNameObject, kUnknownCommand);
  if (((frame.data[0] & 0x10) != 0) != toggle_) return abort_sdo(kNameObject, 0x05030000);
  const std::string_view part = kNodeName.substr(*text_at_, 7);
  *text_at_ += part.size();
  const bool last = *text_at_ >= kNodeName.size();
  const auto at = [&](std::size_t i) { return i < part.size() ? static_cast<std::uint8_t>(part[i]) : std::uint8_t{0}; };
  const auto command =
      static_cast<std::uint8_t>((toggle_ ? 0x10 : 0) | static_cast<int>(7 - part.size()) << 1 | (last ? 1 : 0));
  send(0x580, {command, at(0), at(1), at(2), at(3), at(4), at(5), at(6)});
  toggle_ = !toggle_;
  if (last) text_at_.reset();
}

void AxisNode::download(const BusFrame& frame, const ObjectKey& key) {
  const int command = frame.data[0];
  if ((command & 0x02) == 0) return abort_sdo(key, kUnknownCommand);  // segmented: no object here is that long
  const int bytes = (command & 0x01) != 0 ? 4 - (command >> 2 & 3) : 0;
  const std::uint32_t value = word_in(frame, 4, bytes == 0 ? 4 : bytes);
  if (const auto refused = objects_->write(key, value, bytes, nmt_ == Nmt::pre_operational))
    return abort_sdo(key, *refused);
  applied(key);
  send(0x580, {0x60, frame.data[1], frame.data[2], frame.data[3], 0, 0, 0, 0});
}

}  // namespace luxrig::sim
