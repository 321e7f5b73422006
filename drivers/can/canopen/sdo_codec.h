#pragma once
/// Service data objects of CANopen (CiA 301, 7.2.4.3): client requests and server answers, 8 bytes each. Writes are
/// expedited (at most 4 bytes); reads are expedited or segmented. Pure.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace luxrig::canopen {

using SdoBytes = std::array<std::uint8_t, 8>;

/// An entry of the object dictionary.
struct ObjectAddress {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  bool operator==(const ObjectAddress&) const = default;
};
/// "607D:1", in hexadecimal
[[nodiscard]] std::string text_of(const ObjectAddress& object);

/// requires 1 to 4 bytes, little-endian.
[[nodiscard]] SdoBytes encode_download(const ObjectAddress& object, std::span<const std::uint8_t> value);
[[nodiscard]] SdoBytes encode_upload(const ObjectAddress& object);
[[nodiscard]] SdoBytes encode_upload_segment(bool toggle);
[[nodiscard]] SdoBytes encode_abort(const ObjectAddress& object, std::uint32_t code);

enum class SdoAnswerKind {
  downloaded,  ///< a write was done: `object`
  uploaded,    ///< a whole value of at most 4 bytes: `object`, `bytes` (4 if no size was given)
  started,     ///< a longer value follows in segments: `object`, `size` if given
  segment,     ///< a part of it: `toggle`, `bytes`, `last`
  aborted,     ///< refused: `object`, `abort_code`
  garbled      ///< breaks the protocol
};

struct SdoAnswer {
  SdoAnswerKind kind = SdoAnswerKind::garbled;
  ObjectAddress object;
  std::vector<std::uint8_t> bytes;
  std::uint32_t size = 0;  ///< 0 = not given
  std::uint32_t abort_code = 0;
  bool toggle = false, last = false;
};

[[nodiscard]] SdoAnswer decode_sdo_answer(std::span<const std::uint8_t> frame);

inline constexpr std::uint32_t kAbortToggle = 0x05030000, kAbortTimeout = 0x05040000, kAbortOutOfMemory = 0x05040005;
/// "object does not exist (06020000)"
[[nodiscard]] std::string abort_text(std::uint32_t code);

}  // namespace luxrig::canopen
