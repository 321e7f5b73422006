#include "drivers/can/canopen/sdo_codec.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "core/check.h"

namespace luxrig::canopen {
namespace {

SdoBytes with_object(int command, const ObjectAddress& object) {
  SdoBytes bytes{};
  bytes[0] = static_cast<std::uint8_t>(command);
  bytes[1] = static_cast<std::uint8_t>(object.index & 0xFF);
  bytes[2] = static_cast<std::uint8_t>(object.index >> 8);
  bytes[3] = object.sub;
  return bytes;
}

std::uint32_t word_at_4(std::span<const std::uint8_t> bytes) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i) word |= static_cast<std::uint32_t>(bytes[4 + i]) << (8 * i);
  return word;
}

struct AbortName {
  std::uint32_t code;
  std::string_view name;
};

// CiA 301, table 22.
constexpr AbortName kAbortNames[] = {
    {0x05030000, "toggle bit not alternated"},
    {0x05040000, "SDO protocol timed out"},
    {0x05040001, "client or server command unknown"},
    {0x05040002, "invalid block size"},
    {0x05040003, "invalid sequence number"},
    {0x05040004, "CRC error"},
    {0x05040005, "out of memory"},
    {0x06010000, "access not supported"},
    {0x06010001, "object is write only"},
    {0x06010002, "object is read only"},
    {0x06020000, "object does not exist"},
    {0x06040041, "object cannot be mapped to the PDO"},
    {0x06040042, "mapped objects exceed the PDO's length"},
    {0x06040043, "parameters are incompatible"},
    {0x06040047, "internal incompatibility of the device"},
    {0x06060000, "access failed for a hardware error"},
    {0x06070010, "length does not match"},
    {0x06070012, "length too high"},
    {0x06070013, "length too low"},
    {0x06090011, "sub-index does not exist"},
    {0x06090030, "value out of range"},
    {0x06090031, "value too high"},
    {0x06090032, "value too low"},
    {0x06090036, "maximum is below minimum"},
    {0x060A0023, "resource not available"},
    {0x08000000, "general error"},
    {0x08000020, "data cannot be transferred or stored"},
    {0x08000021, "data cannot be transferred for local control"},
    {0x08000022, "not possible in the device's present state"},
    {0x08000023, "no object dictionary"},
    {0x08000024, "no data available"},
};

}  // namespace

std::string text_of(const ObjectAddress& object) { return fmt::format("{:04X}:{:X}", object.index, object.sub); }

SdoBytes encode_download(const ObjectAddress& object, std::span<const std::uint8_t> value) {
  LUXRIG_CHECK(!value.empty() && value.size() <= 4, "{} bytes", value.size());
  SdoBytes bytes = with_object(0x23 | static_cast<int>(4 - value.size()) << 2, object);
  std::copy(value.begin(), value.end(), bytes.begin() + 4);
  return bytes;
}

SdoBytes encode_upload(const ObjectAddress& object) { return with_object(0x40, object); }

SdoBytes encode_upload_segment(bool toggle) {
  SdoBytes bytes{};
  bytes[0] = toggle ? 0x70 : 0x60;
  return bytes;
}

SdoBytes encode_abort(const ObjectAddress& object, std::uint32_t code) {
  SdoBytes bytes = with_object(0x80, object);
  for (std::size_t i = 0; i < 4; ++i) bytes[4 + i] = static_cast<std::uint8_t>(code >> (8 * i));
  return bytes;
}

SdoAnswer decode_sdo_answer(std::span<const std::uint8_t> frame) {
  SdoAnswer answer;
  if (frame.size() != 8) return answer;
  const int command = frame[0];
  answer.object = {static_cast<std::uint16_t>(frame[1] | frame[2] << 8), frame[3]};
  switch (command >> 5) {
    case 0: {  // upload segment
      const auto unused = static_cast<std::size_t>(command >> 1 & 7);
      answer.kind = SdoAnswerKind::segment;
      answer.object = {};
      answer.toggle = (command & 0x10) != 0;
      answer.last = (command & 1) != 0;
      answer.bytes.assign(frame.begin() + 1, frame.end() - static_cast<std::ptrdiff_t>(unused));
      return answer;
    }
    case 2: {  // upload initiated
      const bool expedited = (command & 2) != 0, sized = (command & 1) != 0;
      if (!expedited) {
        answer.kind = SdoAnswerKind::started;
        answer.size = sized ? word_at_4(frame) : 0;
        return answer;
      }
      const auto unused = sized ? static_cast<std::size_t>(command >> 2 & 3) : 0;
      answer.kind = SdoAnswerKind::uploaded;
      answer.bytes.assign(frame.begin() + 4, frame.end() - static_cast<std::ptrdiff_t>(unused));
      return answer;
    }
    case 3:
      answer.kind = SdoAnswerKind::downloaded;
      return answer;
    case 4:
      answer.kind = SdoAnswerKind::aborted;
      answer.abort_code = word_at_4(frame);
      return answer;
    default:
      return answer;
  }
}

std::string abort_text(std::uint32_t code) {
  const auto found = std::find_if(std::begin(kAbortNames), std::end(kAbortNames),
                                  [code](const AbortName& entry) { return entry.code == code; });
  return fmt::format("{} ({:08X})", found == std::end(kAbortNames) ? "unknown reason" : found->name, code);
}

}  // namespace luxrig::canopen
