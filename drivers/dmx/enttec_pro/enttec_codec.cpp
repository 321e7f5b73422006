#include "drivers/dmx/enttec_pro/enttec_codec.h"

#include <fmt/format.h>

#include <algorithm>

namespace luxrig::enttec {
namespace {

constexpr std::uint8_t kStart = 0x7e, kEnd = 0xe7;
constexpr std::size_t kFraming = 5;  // start, label, length, end

}  // namespace

std::vector<std::uint8_t> encode(Label label, std::span<const std::uint8_t> data) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(data.size() + kFraming);
  bytes.push_back(kStart);
  bytes.push_back(static_cast<std::uint8_t>(label));
  bytes.push_back(static_cast<std::uint8_t>(data.size() & 0xff));
  bytes.push_back(static_cast<std::uint8_t>(data.size() >> 8));
  bytes.insert(bytes.end(), data.begin(), data.end());
  bytes.push_back(kEnd);
  return bytes;
}

std::vector<std::uint8_t> encode_output(const DmxSlots& slots) {
  std::vector<std::uint8_t> data(1 + slots.size());  // start code 0
  std::copy(slots.begin(), slots.end(), data.begin() + 1);
  return encode(Label::output_dmx, data);
}

std::optional<Message> StreamDecoder::next() {
  std::optional<Message> message;
  std::size_t at = 0;  // everything before it is processed
  while (at < bytes_.size() && !message) {
    if (bytes_[at] != kStart) {
      ++at;
      ++dropped_;
      continue;
    }
    if (bytes_.size() - at < 4) break;
    const auto length = static_cast<std::size_t>(bytes_[at + 2] | bytes_[at + 3] << 8);
    if (length <= kMaxData && bytes_.size() - at < length + kFraming) break;
    if (length > kMaxData || bytes_[at + 4 + length] != kEnd) {
      ++at;
      ++dropped_;
      continue;
    }
    const auto data = bytes_.begin() + static_cast<std::ptrdiff_t>(at + 4);
    message = Message{bytes_[at + 1], {data, data + static_cast<std::ptrdiff_t>(length)}};
    at += length + kFraming;
  }
  bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(at));
  return message;
}

void StreamDecoder::give_up() {
  if (bytes_.empty()) return;
  bytes_.erase(bytes_.begin());
  ++dropped_;
}

int units_of_us(int us) { return (us * 3 + 16) / 32; }

std::optional<Parameters> decode_parameters(std::span<const std::uint8_t> data) {
  if (data.size() < 5) return std::nullopt;
  const Parameters parameters{data[0] | data[1] << 8, data[2], data[3], data[4]};
  if (parameters.break_units < 9 || parameters.break_units > 127 || parameters.mark_units < 1 ||
      parameters.mark_units > 127 || parameters.rate_hz > 40) {
    return std::nullopt;
  }
  return parameters;
}

std::vector<std::uint8_t> encode_set_parameters(const Parameters& parameters) {
  const std::uint8_t data[] = {0, 0, static_cast<std::uint8_t>(parameters.break_units),
                               static_cast<std::uint8_t>(parameters.mark_units),
                               static_cast<std::uint8_t>(parameters.rate_hz)};
  return encode(Label::set_parameters, data);
}

std::optional<std::string> decode_serial(std::span<const std::uint8_t> data) {
  if (data.size() < 4) return std::nullopt;
  return fmt::format("{:02x}{:02x}{:02x}{:02x}", data[3], data[2], data[1], data[0]);
}

std::optional<std::string> decode_name(std::span<const std::uint8_t> data) {
  if (data.size() < 2) return std::nullopt;
  std::string name;
  for (const std::uint8_t byte : data.subspan(2)) {
    if (byte == 0) break;
    name += byte >= 0x20 && byte < 0x7f ? static_cast<char>(byte) : '?';
  }
  return name;
}

}  // namespace luxrig::enttec
