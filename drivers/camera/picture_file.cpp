#include "drivers/camera/picture_file.h"

#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

namespace luxrig {
namespace {

tl::unexpected<Fault> bad_picture(std::string detail) {
  return tl::unexpected(Fault{Cause::protocol, {}, std::move(detail), {}});
}

bool is_blank(char letter) { return letter == ' ' || letter == '\n' || letter == '\t' || letter == '\r'; }

/// The next word of a netpbm header, without comments. Also consumes the one blank after it.
std::string_view header_word(std::string_view& rest) {
  while (!rest.empty() && (is_blank(rest.front()) || rest.front() == '#')) {
    if (rest.front() == '#') rest.remove_prefix(std::min(rest.find('\n'), rest.size()));
    if (!rest.empty()) rest.remove_prefix(1);
  }
  std::size_t end = 0;
  while (end < rest.size() && end < 32 && !is_blank(rest[end])) ++end;
  if (end == rest.size() || !is_blank(rest[end])) return {};
  const std::string_view word = rest.substr(0, end);
  rest.remove_prefix(end + 1);
  return word;
}

template <class T>
bool header_number(std::string_view& rest, T& out) {
  const std::string_view word = header_word(rest);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), out);
  return !word.empty() && error == std::errc() && end == word.data() + word.size();
}

/// A picture of that size without samples; a fault if the size is impossible.
Result<RawPicture> sized(int width_px, int height_px, int channels) {
  if (width_px < 1 || height_px < 1 || width_px > kMaxPictureSide_px || height_px > kMaxPictureSide_px ||
      static_cast<long long>(width_px) * height_px > kMaxPicturePixels)
    return bad_picture(fmt::format("a picture of {} x {} pixels", width_px, height_px));
  RawPicture picture;
  picture.width_px = width_px;
  picture.height_px = height_px;
  picture.channels = channels;
  return picture;
}

std::size_t samples_of(const RawPicture& picture) {
  return static_cast<std::size_t>(picture.width_px) * static_cast<std::size_t>(picture.height_px) *
         static_cast<std::size_t>(picture.channels);
}

}  // namespace

Result<RawPicture> decode_pnm(std::string_view bytes) {
  const std::string_view magic = header_word(bytes);
  int width = 0, height = 0, most = 0;
  if ((magic != "P5" && magic != "P6") || !header_number(bytes, width) || !header_number(bytes, height) ||
      !header_number(bytes, most))
    return bad_picture("not a binary PGM or PPM file");
  auto picture = sized(width, height, magic == "P6" ? 3 : 1);
  if (!picture) return picture;
  if (most < 1 || most > 65535) return bad_picture(fmt::format("a picture whose largest sample is {}", most));
  picture->full_scale_counts = most;
  const std::size_t count = samples_of(*picture), per_sample = most > 255 ? 2 : 1;
  if (bytes.size() < count * per_sample)
    return bad_picture(fmt::format("a picture with {} of {} bytes", bytes.size(), count * per_sample));
  picture->samples.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto byte = [&](std::size_t at) { return static_cast<int>(static_cast<unsigned char>(bytes[at])); };
    const int sample = per_sample == 2 ? byte(2 * i) << 8 | byte(2 * i + 1) : byte(i);
    if (sample > most) return bad_picture(fmt::format("a sample of {} in a picture with {} at most", sample, most));
    picture->samples.push_back(static_cast<float>(sample) / static_cast<float>(most));
  }
  return picture;
}

Result<RawPicture> decode_float_map(std::string_view bytes) {
  const std::string_view magic = header_word(bytes);
  int width = 0, height = 0;
  float scale = 0;
  if ((magic != "PF" && magic != "Pf") || !header_number(bytes, width) || !header_number(bytes, height) ||
      !header_number(bytes, scale) || !std::isfinite(scale) || scale == 0)
    return bad_picture("not a PFM file");
  auto picture = sized(width, height, magic == "PF" ? 3 : 1);
  if (!picture) return picture;
  picture->is_light = true;
  const std::size_t count = samples_of(*picture);
  if (bytes.size() != 4 * count)
    return bad_picture(fmt::format("a picture with {} of {} bytes", bytes.size(), 4 * count));
  const std::size_t row = count / static_cast<std::size_t>(height);
  picture->samples.reserve(count);
  for (std::size_t y = static_cast<std::size_t>(height); y-- > 0;)  // the last row comes first
    for (std::size_t i = 0; i < row; ++i) {
      std::uint32_t word = 0;
      std::memcpy(&word, bytes.data() + 4 * (y * row + i), 4);
      if ((scale < 0) != (std::endian::native == std::endian::little)) word = __builtin_bswap32(word);
      const auto light = std::bit_cast<float>(word);
      if (!std::isfinite(light) || light < 0) return bad_picture("a picture with samples that are no light");
      picture->samples.push_back(light);
    }
  return picture;
}

Result<RawPicture> decode_picture(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) return decode_png(bytes);
  if (bytes.starts_with("P5") || bytes.starts_with("P6")) return decode_pnm(bytes);
  if (bytes.starts_with("PF") || bytes.starts_with("Pf")) return decode_float_map(bytes);
  return bad_picture("neither PNG, PGM, PPM nor PFM");
}

}  // namespace luxrig
