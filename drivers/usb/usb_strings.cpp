#include "drivers/usb/usb_strings.h"

#include <algorithm>

namespace luxrig {
namespace {

void append_utf8(std::string& text, std::uint32_t c) {
  const auto put = [&](std::uint32_t byte) { text.push_back(static_cast<char>(byte)); };
  if (c < 0x20 || c == 0x7f || (c >= 0xd800 && c < 0xe000)) return text.push_back('?');
  if (c < 0x80) return put(c);
  if (c < 0x800) {
    put(0xc0 | c >> 6);
    return put(0x80 | (c & 0x3f));
  }
  if (c < 0x10000) {
    put(0xe0 | c >> 12);
    put(0x80 | (c >> 6 & 0x3f));
    return put(0x80 | (c & 0x3f));
  }
  put(0xf0 | c >> 18);
  put(0x80 | (c >> 12 & 0x3f));
  put(0x80 | (c >> 6 & 0x3f));
  put(0x80 | (c & 0x3f));
}

}  // namespace

std::string text_of_string_descriptor(std::span<const std::uint8_t> bytes) {
  std::string text;
  if (bytes.size() < 2 || bytes[1] != 3) return text;
  const std::size_t end = std::min<std::size_t>(bytes.size(), bytes[0]);
  for (std::size_t i = 2; i + 1 < end; i += 2) {
    std::uint32_t c = bytes[i] | bytes[i + 1] << 8;
    if (c >= 0xd800 && c < 0xdc00 && i + 3 < end) {
      const std::uint32_t low = bytes[i + 2] | bytes[i + 3] << 8;
      if (low >= 0xdc00 && low < 0xe000) {
        c = 0x10000 + ((c - 0xd800) << 10) + (low - 0xdc00);
        i += 2;
      }
    }
    append_utf8(text, c);
  }
  return text;
}

}  // namespace luxrig
