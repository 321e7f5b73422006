#include "sim/devices/usb/enttec_widget.h"

#include <algorithm>
#include <string_view>

namespace luxrig::sim {
namespace {

constexpr std::uint8_t kSom = 0x7e, kEom = 0xe7;
constexpr std::size_t kLongest = 600, kMaxSaid = 4096;
constexpr std::uint8_t kFirmware[] = {0x44, 0x01}, kRdmFirmware[] = {0x04, 0x02};  // 1.68, 2.4
constexpr std::uint8_t kSerialBcd[] = {0x12, 0x34, 0x56, 0x02};

std::vector<std::uint8_t> named(std::uint16_t id, std::string_view name) {
  std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(id), static_cast<std::uint8_t>(id >> 8)};
  bytes.insert(bytes.end(), name.begin(), name.end());
  return bytes;
}

}  // namespace

void EnttecWidget::power_on(Time) {
  heard_.clear();
  said_.clear();
  look_.reset();
  putting_out_ = false;
}

void EnttecWidget::receive(Time start, Duration, const LineSettings&, std::span<const std::uint8_t> bytes) {
  heard_.insert(heard_.end(), bytes.begin(), bytes.end());
  std::size_t at = 0;
  const auto skip = [&] {
    ++at;
    ++dropped_;
  };
  while (at < heard_.size()) {
    const std::span<const std::uint8_t> rest = std::span(heard_).subspan(at);
    if (rest[0] != kSom) {
      skip();
      continue;
    }
    if (rest.size() < 4) break;
    const std::size_t length = rest[2] + 256u * rest[3];
    if (length > kLongest) {
      skip();
      continue;
    }
    if (rest.size() < 4 + length + 1) break;
    if (rest[4 + length] != kEom) {
      skip();
      continue;
    }
    obey(start, rest[1], rest.subspan(4, length));
    at += 4 + length + 1;
  }
  heard_.erase(heard_.begin(), heard_.begin() + static_cast<std::ptrdiff_t>(at));
}

void EnttecWidget::obey(Time now, std::uint8_t label, std::span<const std::uint8_t> data) {
  if (label != 6 && label != 3 && putting_out_) {
    putting_out_ = false;
    ++stops_;
  }
  switch (label) {
    case 3: {
      const auto& firmware = line_answer_ ? kRdmFirmware : kFirmware;
      const std::uint8_t parameters[] = {firmware[0], firmware[1], static_cast<std::uint8_t>(break_units_),
                                         static_cast<std::uint8_t>(mark_units_), static_cast<std::uint8_t>(rate_hz_)};
      return answer(3, parameters);
    }
    case 4:
      if (data.size() < 5 || data[2] < 9 || data[2] > 127 || data[3] < 1 || data[3] > 127 || data[4] > 40) return;
      break_units_ = data[2];
      mark_units_ = data[3];
      rate_hz_ = data[4];
      return;
    case 6: {
      // At least 24 slots, or packets would come faster than DMX allows.
      if (data.size() < 25 || data.size() > 1 + kDmxSlots || data[0] != 0) return;
      UsbDmxLook look = look_.value_or(UsbDmxLook{});
      std::copy(data.begin() + 1, data.end(), look.begin());
      look_ = look;
      putting_out_ = true;
      ++frames_;
      return;
    }
    case 7:
    case 11:
      return ask_line(now, data);
    case 10:
      return answer(10, kSerialBcd);
    case 77:
      if (character_.says_names) answer(77, named(0x6a6b, "Luxrig"));
      return;
    case 78:
      if (character_.says_names) answer(78, named(1, "simulated DMX USB Pro"));
      return;
    default:
      return;
  }
}

void EnttecWidget::ask_line(Time now, std::span<const std::uint8_t> packet) {
  if (!line_answer_) return;
  const std::vector<std::uint8_t> heard = line_answer_(now, packet);
  if (heard.empty()) return answer(12, {});
  std::vector<std::uint8_t> received{0};  // nothing was lost
  received.insert(received.end(), heard.begin(), heard.end());
  answer(5, received);
}

void EnttecWidget::answer(std::uint8_t label, std::span<const std::uint8_t> data) {
  if (character_.silent || said_.size() > kMaxSaid) return;
  said_.insert(said_.end(), character_.noise.begin(), character_.noise.end());
  const std::uint8_t head[] = {kSom, label, static_cast<std::uint8_t>(data.size()),
                               static_cast<std::uint8_t>(data.size() >> 8)};
  said_.insert(said_.end(), std::begin(head), std::end(head));
  said_.insert(said_.end(), data.begin(), data.end());
  said_.push_back(character_.wrong_end ? 0xe6 : kEom);
}

std::vector<std::uint8_t> EnttecWidget::take(Time, std::size_t most) {
  const auto end = said_.begin() + static_cast<std::ptrdiff_t>(std::min(most, said_.size()));
  std::vector<std::uint8_t> bytes(said_.begin(), end);
  said_.erase(said_.begin(), end);
  return bytes;
}

}  // namespace luxrig::sim
