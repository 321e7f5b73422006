#include "core/picture/pfm.h"

#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

namespace luxrig {
namespace {

constexpr int kMaxSide_px = 16384;
static_assert(std::endian::native == std::endian::little, "samples are copied as they are");

/// The next word of the header, consumed with one white space; empty if there is none.
std::string_view next_word(std::string_view& rest) {
  std::size_t end = 0;
  while (end < rest.size() && end < 32 && rest[end] != ' ' && rest[end] != '\n') ++end;
  if (end == 0 || end == rest.size() || (rest[end] != ' ' && rest[end] != '\n')) return {};
  const std::string_view word = rest.substr(0, end);
  rest.remove_prefix(end + 1);
  return word;
}

template <class T>
bool read_all_of(std::string_view word, T& out) {
  const auto [stopped, error] = std::from_chars(word.data(), word.data() + word.size(), out);
  return error == std::errc() && stopped == word.data() + word.size();
}

}  // namespace

std::string to_pfm(const Picture& picture) {
  std::string bytes = fmt::format("PF\n{} {}\n-1.0\n", picture.width_px, picture.height_px);
  const auto row = static_cast<std::size_t>(picture.width_px);
  for (auto y = static_cast<std::size_t>(picture.height_px); y-- > 0;)
    bytes.append(reinterpret_cast<const char*>(picture.luminance_cd_m2.data() + y * row), row * sizeof(Vec3f));
  return bytes;
}

Result<Picture> picture_from_pfm(std::string_view bytes) {
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  Picture picture;
  float scale = 0;
  if (next_word(bytes) != "PF" || !read_all_of(next_word(bytes), picture.width_px) ||
      !read_all_of(next_word(bytes), picture.height_px) || !read_all_of(next_word(bytes), scale))
    return refusal("not a colour picture of the format PFM");
  if (picture.width_px < 1 || picture.width_px > kMaxSide_px || picture.height_px < 1 ||
      picture.height_px > kMaxSide_px)
    return refusal(fmt::format("a picture of {} x {} pixels", picture.width_px, picture.height_px));
  if (!(scale < 0)) return refusal("a picture with big-endian samples");
  const auto row = static_cast<std::size_t>(picture.width_px), rows = static_cast<std::size_t>(picture.height_px);
  if (bytes.size() != row * rows * sizeof(Vec3f))
    return refusal(fmt::format("a picture of {} x {} pixels with {} bytes of samples", row, rows, bytes.size()));
  picture.luminance_cd_m2.resize(row * rows);
  for (std::size_t y = 0; y < rows; ++y)
    std::memcpy(static_cast<void*>(picture.luminance_cd_m2.data() + (rows - 1 - y) * row),
                bytes.data() + y * row * sizeof(Vec3f), row * sizeof(Vec3f));
  for (const Vec3f& pixel : picture.luminance_cd_m2)
    if (!pixel.allFinite() || pixel.minCoeff() < 0) return refusal("a picture with samples that are no luminance");
  return picture;
}

}  // namespace luxrig
