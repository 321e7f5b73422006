#include "sim/devices/rdm_responder.h"

#include <algorithm>
#include <cmath>

namespace luxrig::sim {
namespace {

constexpr int kAck = 0, kAckTimer = 1, kNack = 2, kAckOverflow = 3;
constexpr int kDiscovery = 0x10, kGet = 0x20, kSet = 0x30;
constexpr int kBranch = 0x0001, kMute = 0x0002, kUnMute = 0x0003;
constexpr int kQueuedMessage = 0x0020, kStatusMessages = 0x0030, kSupported = 0x0050, kDeviceInfo = 0x0060;
constexpr int kModel = 0x0080, kManufacturer = 0x0081, kLabel = 0x0082, kSoftware = 0x00c0;
constexpr int kPersonality = 0x00e0, kPersonalityDescription = 0x00e1, kAddress = 0x00f0, kSlotInfo = 0x0120;
constexpr int kSensorDefinition = 0x0200, kSensorValue = 0x0201, kDeviceHours = 0x0400, kLampHours = 0x0401;
constexpr int kLampState = 0x0403, kIdentify = 0x1000;
// SUPPORTED_PARAMETERS omits those that every responder must have.
constexpr int kListed[] = {
    kQueuedMessage, kStatusMessages,   kModel,       kManufacturer, kLabel,     kPersonality, kPersonalityDescription,
    kSlotInfo,      kSensorDefinition, kSensorValue, kDeviceHours,  kLampHours, kLampState};
constexpr int kUnknownPid = 0, kFormatError = 1, kWriteProtect = 4, kUnsupportedClass = 5, kOutOfRange = 6;
constexpr int kSubDeviceOutOfRange = 9;

constexpr int kLastSlot = 512;
constexpr std::size_t kMaxLabelBytes = 32;
constexpr Duration kBallastTakes = std::chrono::milliseconds(300);
constexpr std::uint8_t kTimerTenths = 3;
constexpr double kRoom_c = 25, kRiseAtFull_c = 40, kWarming_s = 120;

void append_16(std::vector<std::uint8_t>& bytes, int value) {
  bytes.push_back(static_cast<std::uint8_t>(value >> 8 & 0xff));
  bytes.push_back(static_cast<std::uint8_t>(value & 0xff));
}

std::vector<std::uint8_t> label_bytes(const std::string& text) {
  const auto size = static_cast<std::ptrdiff_t>(std::min(text.size(), kMaxLabelBytes));
  return {text.begin(), text.begin() + size};
}

bool only_read(int pid) {
  return pid == kDeviceInfo || pid == kSoftware ||
         (std::find(std::begin(kListed), std::end(kListed), pid) != std::end(kListed) && pid != kLabel &&
          pid != kPersonality && pid != kSensorValue);
}

}  // namespace

RdmResponder::RdmResponder(RdmIdentity identity)
    : identity_(std::move(identity)), temperature_c_(kRoom_c), lowest_c_(kRoom_c), highest_c_(kRoom_c) {}

void RdmResponder::power_up() {
  muted_ = identifies_ = false;
  queue_.clear();
  last_queued_.reset();
  overflow_pid_.reset();
}

void RdmResponder::shine(Time now, double level) {
  if (shone_ && now > *shone_) {
    const double seconds = to_seconds(now - *shone_);
    on_h_ += seconds / 3600;
    if (level_ > 0) lit_h_ += seconds / 3600;
    const double towards_c = kRoom_c + kRiseAtFull_c * level_;
    temperature_c_ = towards_c + (temperature_c_ - towards_c) * std::exp(-seconds / kWarming_s);
    lowest_c_ = std::min(lowest_c_, temperature_c_);
    highest_c_ = std::max(highest_c_, temperature_c_);
  }
  shone_ = now;
  level_ = level;
}

std::vector<std::uint8_t> RdmResponder::receive(Time now, std::span<const std::uint8_t> bytes) {
  const auto request = read_rdm(bytes);
  if (!request) return {};
  const std::uint64_t all_of_ours = (identity_.uid & 0xffff00000000) | 0xffffffff;
  const bool broadcast = request->to == kRdmEverybody || request->to == all_of_ours;
  if (!broadcast && request->to != identity_.uid) return {};
  if (request->command_class == kDiscovery) {
    const bool to_all = broadcast && request->pid != kBranch;
    auto answer = discover(*request);
    return to_all ? std::vector<std::uint8_t>{} : answer;
  }
  if (request->command_class != kGet && request->command_class != kSet) return {};
  if (broadcast && request->command_class == kGet) return {};

  RdmFrame answer = *request;
  std::swap(answer.to, answer.from);
  answer.command_class = request->command_class + 1;
  if (!(request->command_class == kGet && overflow_pid_ == request->pid)) overflow_pid_.reset();
  const auto from_queue = request->sub_device == 0 ? queued(now, *request) : std::nullopt;
  if (from_queue) {
    answer = *from_queue;
  } else {
    Reply reply;
    if (request->sub_device != 0 && !(request->sub_device == 0xffff && request->command_class == kSet)) {
      reply = {kNack, {0, kSubDeviceOutOfRange}};
    } else if (overflow_pid_) {
      reply.data = std::move(overflow_);
    } else {
      reply = request->command_class == kGet ? get(*request) : set(*request);
    }
    if (reply.type == kAck && request->command_class == kGet && request->pid == kLampHours) {
      answer.port_or_type = kAck;
      answer.data = std::move(reply.data);
      queue_.push_back({now + kBallastTakes, answer});
      reply = {kAckTimer, {0, kTimerTenths}};
    }
    overflow_pid_.reset();
    if (reply.data.size() > kMaxRdmData) {
      overflow_.assign(reply.data.begin() + kMaxRdmData, reply.data.end());
      overflow_pid_ = request->pid;
      reply.data.resize(kMaxRdmData);
      reply.type = kAckOverflow;
    }
    answer.port_or_type = static_cast<std::uint8_t>(reply.type);
    answer.data = std::move(reply.data);
  }
  answer.transaction = request->transaction;
  answer.messages = static_cast<std::uint8_t>(std::min<std::ptrdiff_t>(
      std::count_if(queue_.begin(), queue_.end(), [now](const Waiting& waiting) { return waiting.ready <= now; }),
      255));
  return broadcast ? std::vector<std::uint8_t>{} : write_rdm(answer);
}

std::vector<std::uint8_t> RdmResponder::discover(const RdmFrame& request) {
  if (request.pid == kBranch) {
    if (muted_ || request.data.size() != 12 || request.to != kRdmEverybody) return {};
    std::uint64_t lowest = 0, highest = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      lowest = lowest << 8 | request.data[i];
      highest = highest << 8 | request.data[6 + i];
    }
    return identity_.uid >= lowest && identity_.uid <= highest ? write_branch_answer(identity_.uid)
                                                               : std::vector<std::uint8_t>{};
  }
  if ((request.pid != kMute && request.pid != kUnMute) || !request.data.empty()) return {};
  muted_ = request.pid == kMute;
  RdmFrame answer = request;
  std::swap(answer.to, answer.from);
  answer.command_class = kDiscovery + 1;
  answer.port_or_type = kAck;
  answer.messages = 0;
  answer.data = {0, 0};  // control field: no proxy, no sub-devices
  return write_rdm(answer);
}

std::optional<RdmFrame> RdmResponder::queued(Time now, const RdmFrame& request) {
  if (request.pid != kQueuedMessage || request.command_class != kGet) return std::nullopt;
  RdmFrame answer = request;
  std::swap(answer.to, answer.from);
  answer.command_class = kGet + 1;
  answer.port_or_type = kNack;
  answer.data = {0, kFormatError};
  if (request.data.size() != 1 || request.data[0] < 1 || request.data[0] > 4) return answer;
  if (request.data[0] == 1 && last_queued_) return last_queued_;
  const auto ready =
      std::find_if(queue_.begin(), queue_.end(), [now](const Waiting& waiting) { return waiting.ready <= now; });
  if (ready == queue_.end()) {
    answer.pid = kStatusMessages;
    answer.port_or_type = kAck;
    answer.data.clear();
    return answer;
  }
  last_queued_ = ready->answer;
  queue_.erase(ready);
  return last_queued_;
}

RdmResponder::Reply RdmResponder::get(const RdmFrame& request) {
  const bool with_data =
      request.pid == kPersonalityDescription || request.pid == kSensorDefinition || request.pid == kSensorValue;
  if (request.data.size() != (with_data ? 1 : 0)) return {kNack, {0, kFormatError}};
  Bytes data;
  switch (request.pid) {
    case kSupported:
      for (const int pid : kListed) append_16(data, pid);
      return {kAck, data};
    case kDeviceInfo:
      return {kAck, device_info()};
    case kModel:
      return {kAck, label_bytes(identity_.model)};
    case kManufacturer:
      return {kAck, label_bytes(identity_.manufacturer)};
    case kLabel:
      return {kAck, label_bytes(identity_.label)};
    case kSoftware:
      return {kAck, label_bytes("simulated 1")};
    case kPersonality:
      return {kAck, {1, 1}};
    case kPersonalityDescription:
      return personality_description(request.data[0]);
    case kAddress:
      append_16(data, footprint() == 0 ? 0xffff : identity_.address);
      return {kAck, data};
    case kSlotInfo:
      return {kAck, slot_info()};
    case kSensorDefinition:
    case kSensorValue:
      return sensor(request);
    case kDeviceHours:
      return {kAck, hours(on_h_, identity_.lamp_hours)};
    case kLampHours:
      return {kAck, hours(lit_h_, identity_.lamp_hours)};
    case kLampState:
      return {kAck, {static_cast<std::uint8_t>(level_ > 0 ? 1 : 0)}};
    case kIdentify:
      return {kAck, {static_cast<std::uint8_t>(identifies_ ? 1 : 0)}};
    case kStatusMessages:
      return {kAck, {}};
    default:
      return {kNack, {0, kUnknownPid}};
  }
}

RdmResponder::Reply RdmResponder::set(const RdmFrame& request) {
  const Bytes& data = request.data;
  if (only_read(request.pid)) return {kNack, {0, kUnsupportedClass}};
  const bool known = request.pid == kLabel || request.pid == kPersonality || request.pid == kAddress ||
                     request.pid == kSensorValue || request.pid == kIdentify;
  if (!known) return {kNack, {0, kUnknownPid}};
  if (identity_.write_protected && request.pid != kIdentify) return {kNack, {0, kWriteProtect}};
  switch (request.pid) {
    case kLabel:
      if (data.size() > kMaxLabelBytes) return {kNack, {0, kFormatError}};
      identity_.label.assign(data.begin(), data.end());
      return {};
    case kPersonality:
      if (data.size() != 1) return {kNack, {0, kFormatError}};
      if (data[0] != 1) return {kNack, {0, kOutOfRange}};
      return {};
    case kAddress: {
      if (data.size() != 2) return {kNack, {0, kFormatError}};
      const int address = data[0] << 8 | data[1];
      if (footprint() == 0 || address < 1 || address + footprint() - 1 > kLastSlot) return {kNack, {0, kOutOfRange}};
      identity_.address = address;
      return {};
    }
    case kSensorValue:
      if (data.size() != 1) return {kNack, {0, kFormatError}};
      if (data[0] != 0 && data[0] != 0xff) return {kNack, {0, kOutOfRange}};
      lowest_c_ = highest_c_ = temperature_c_;
      return sensor(request);
    default:
      if (data.size() != 1) return {kNack, {0, kFormatError}};
      if (data[0] > 1) return {kNack, {0, kOutOfRange}};
      identifies_ = data[0] == 1;
      return {};
  }
}

RdmResponder::Reply RdmResponder::personality_description(int number) const {
  if (number != 1) return {kNack, {0, kOutOfRange}};
  Bytes data = {1};
  append_16(data, footprint());
  const Bytes text = label_bytes("as patched");
  data.insert(data.end(), text.begin(), text.end());
  return {kAck, data};
}

RdmResponder::Reply RdmResponder::sensor(const RdmFrame& request) const {
  if (request.data[0] != 0 && request.data[0] != 0xff) return {kNack, {0, kOutOfRange}};
  Bytes data = {0};
  const auto tenths = [&data](double celsius) { append_16(data, static_cast<int>(std::lround(celsius * 10))); };
  if (request.pid == kSensorDefinition) {
    if (request.data[0] != 0) return {kNack, {0, kOutOfRange}};
    data.insert(data.end(), {0x00, 0x01, 0x01});  // temperature, °C, deci
    tenths(-40);
    tenths(150);
    tenths(0);
    tenths(kRoom_c + kRiseAtFull_c);
    data.push_back(0x02);  // lowest and highest are recorded
    const Bytes text = label_bytes("housing");
    data.insert(data.end(), text.begin(), text.end());
  } else {
    tenths(temperature_c_);
    tenths(lowest_c_);
    tenths(highest_c_);
    append_16(data, 0);
  }
  return {kAck, data};
}

RdmResponder::Bytes RdmResponder::device_info() const {
  Bytes data = {1, 0};
  append_16(data, identity_.model_id);
  append_16(data, identity_.category);
  append_16(data, 0);
  append_16(data, 1);  // software version
  append_16(data, footprint());
  data.insert(data.end(), {1, 1});
  append_16(data, footprint() == 0 ? 0xffff : identity_.address);
  append_16(data, 0);  // sub-devices
  data.push_back(1);   // sensors
  return data;
}

RdmResponder::Bytes RdmResponder::slot_info() const {
  Bytes data;
  for (std::size_t i = 0; i < identity_.slots.size(); ++i) {
    append_16(data, static_cast<int>(i));
    data.push_back(identity_.slots[i].type);
    append_16(data, identity_.slots[i].label);
  }
  return data;
}

RdmResponder::Bytes RdmResponder::hours(double since_start_h, std::uint32_t before) const {
  const auto total = before + static_cast<std::uint32_t>(since_start_h);
  Bytes data;
  append_16(data, static_cast<int>(total >> 16));
  append_16(data, static_cast<int>(total & 0xffff));
  return data;
}

}  // namespace luxrig::sim
