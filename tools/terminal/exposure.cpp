#include "tools/terminal/exposure.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include "core/photometry/light_colour.h"

namespace luxrig {
namespace {

constexpr double kWhiteOverGrey = 100.0 / 3;  // with the tone curve of picture_png.cpp: 6 / 0.18
constexpr double kBurnShare = 1.0 / 3;        // of white, where the tone curve is at 0.85 of sRGB
constexpr double kLitShare = 1.0 / 50;

/// A number at the start of `text`. The rest stays in `text`.
std::optional<double> take_number(std::string_view& text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || !std::isfinite(value)) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

double at_share(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

/// CIE 1976 u', v'.
Eigen::Vector2d uv_of(const Vec3& rgb) {
  const Chromaticity xy = xy_of_rgb(rgb);
  const double scale = -2 * xy.x() + 12 * xy.y() + 3;
  return {4 * xy.x() / scale, 9 * xy.y() / scale};
}

}  // namespace

std::optional<Exposure> exposure_of(const std::string& text) {
  std::string_view rest = text;
  const auto number = take_number(rest);
  if (!number) return std::nullopt;
  while (rest.starts_with(' ')) rest.remove_prefix(1);
  Exposure exposure;
  if (rest.empty() || rest == "EV" || rest == "stops") {
    if (std::abs(*number) > 20) return std::nullopt;
    exposure.stops = *number;
    return exposure;
  }
  if ((rest != "cd/m2" && rest != "cd/m²") || !(*number > 0)) return std::nullopt;
  exposure.white_cd_m2 = *number;
  return exposure;
}

std::optional<WhiteBalance> white_balance_of(const std::string& text) {
  WhiteBalance balance;
  if (text == "lamps") return balance;
  balance.of_lamps = false;
  if (text == "daylight") return balance;
  std::string_view rest = text;
  const auto number = take_number(rest);
  if (!number || *number < kMinCct_k || *number > kMaxCct_k || (!rest.empty() && rest != "K")) return std::nullopt;
  balance.cct_k = *number;
  return balance;
}

double metered_white_cd_m2(const Picture& picture) {
  std::vector<double> luminances;
  // A sky in the window is brighter than any room. Expose for the surfaces that its light falls on.
  for (std::size_t i = 0; i < picture.luminance_cd_m2.size(); ++i)
    if (const double luminance = luminance_of_rgb(picture.luminance_cd_m2[i].cast<double>());
        luminance > 0 && (picture.illuminance_lx.empty() || picture.illuminance_lx[i] >= 0))
      luminances.push_back(luminance);
  if (luminances.empty()) return kWhiteOverGrey;
  std::sort(luminances.begin(), luminances.end());
  const std::size_t cut = luminances.size() / 100;
  double sum = 0;
  for (std::size_t i = cut; i < luminances.size() - cut; ++i) sum += std::log(luminances[i]);
  const double grey_cd_m2 = std::exp(sum / static_cast<double>(luminances.size() - 2 * cut));
  const double min_lit = kLitShare * at_share(luminances, 0.999);
  luminances.erase(luminances.begin(), std::lower_bound(luminances.begin(), luminances.end(), min_lit));
  return std::max(kWhiteOverGrey * grey_cd_m2, at_share(luminances, 0.98) / kBurnShare);
}

LampWhite white_of_lamps(std::span<const Emitter> emitters, std::span<const double> levels) {
  constexpr double kMaxOff = 0.02;  // in u'v' from the black bodies: still called white
  Vec3 light = Vec3::Zero();
  for (std::size_t e = 0; e < emitters.size(); ++e) {
    if (!(levels[e] > 0)) continue;
    if (emitters[e].sky) return {};
    light += levels[e] * emitters[e].intensity->flux_lm() * emitters[e].colour_rgb;
  }
  const std::optional<Vec3> rgb = with_luminance_1(light);
  if (!rgb) return {};
  const Eigen::Vector2d uv = uv_of(*rgb);
  LampWhite white;
  // Lamps without a stated colour are D65, which no black body has.
  double nearest = std::min(kMaxOff, (uv_of(white.rgb) - uv).norm());
  for (double mired = 1e6 / kMaxCct_k; mired <= 1e6 / kMinCct_k; mired += 1) {
    const double cct_k = std::clamp(1e6 / mired, kMinCct_k, kMaxCct_k);
    const Vec3 body = rgb_of_cct(cct_k);
    const double off = (uv_of(body) - uv).norm();
    if (off < nearest) nearest = off, white = {body, cct_k};
  }
  return white;
}

}  // namespace luxrig
