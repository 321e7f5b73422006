#include "drivers/can/canopen/emergency.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace luxrig::canopen {
namespace {

struct ErrorName {
  std::uint16_t code;
  std::string_view name;
};

constexpr ErrorName kErrorNames[] = {
    {0x0000, "no error"},
    {0x2310, "continuous over-current"},
    {0x2320, "short circuit or earth leakage"},
    {0x3110, "mains over-voltage"},
    {0x3120, "mains under-voltage"},
    {0x3210, "DC link over-voltage"},
    {0x3220, "DC link under-voltage"},
    {0x4210, "drive too hot"},
    {0x4310, "drive too hot"},
    {0x5530, "memory of the drive"},
    {0x6100, "software of the drive"},
    {0x6320, "parameter error"},
    {0x7121, "motor blocked"},
    {0x7305, "encoder 1 faulty"},
    {0x7306, "encoder 2 faulty"},
    {0x8110, "CAN overrun, frames lost"},
    {0x8120, "CAN error-passive"},
    {0x8130, "heartbeat of the master lost"},
    {0x8140, "recovered from bus-off"},
    {0x8150, "CAN identifier collision"},
    {0x8210, "PDO not processed: wrong length"},
    {0x8220, "PDO length exceeded"},
    {0x8311, "excess torque"},
    {0x8611, "following error"},
    {0x8612, "limit of travel"},
};
// By their first byte or first digit.
constexpr ErrorName kClassNames[] = {
    {0x1000, "generic error"},  {0x2000, "current"},         {0x3000, "voltage"},         {0x4000, "temperature"},
    {0x5000, "hardware"},       {0x6000, "software"},        {0x7000, "additional part"}, {0x8000, "monitoring"},
    {0x9000, "external error"}, {0xF000, "its maker's own"},
};

std::string_view name_in(const ErrorName* begin, const ErrorName* end, int code) {
  const auto* found = std::find_if(begin, end, [code](const ErrorName& entry) { return entry.code == code; });
  return found == end ? std::string_view() : found->name;
}

}  // namespace

std::optional<Emergency> decode_emergency(const can::CanFrame& frame) {
  if (frame.size != 8) return std::nullopt;
  Emergency message;
  message.code = static_cast<std::uint16_t>(frame.data[0] | frame.data[1] << 8);
  message.error_register = frame.data[2];
  std::copy_n(frame.data.begin() + 3, 5, message.of_maker.begin());
  return message;
}

std::string error_text(std::uint16_t code) {
  std::string_view name = name_in(std::begin(kErrorNames), std::end(kErrorNames), code);
  if (name.empty()) name = name_in(std::begin(kClassNames), std::end(kClassNames), code & 0xF000);
  return fmt::format("{} ({:04X})", name.empty() ? "unknown error" : name, code);
}

}  // namespace luxrig::canopen
