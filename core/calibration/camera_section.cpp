#include "core/calibration/camera_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/text/plain_text.h"

namespace luxrig {
namespace {

std::string as_base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : kDigits[bits >> (18 - 6 * k) & 63];
  }
  return text;
}

std::string picture_of(const std::string& png, const std::string& says) {
  if (png.empty()) return {};
  return fmt::format("<img src=\"data:image/png;base64,{}\" alt=\"{}\">\n", as_base64(png), escaped_for_markup(says));
}

std::string place_words(const LuxMap::Place& place) {
  if (!place.point.empty()) return escaped_for_markup(place.point);
  const Vec3& at = place.position_world_m;
  return fmt::format("{:.2f}, {:.2f}, {:.2f} m", at.x(), at.y(), at.z());
}

std::string map_section(const LuxMap& map) {
  std::vector<double> lux, shares;
  for (const LuxMap::Place& place : map.places) {
    lux.push_back(place.light.lux);
    if (place.light.lux > 0) shares.push_back(place.light.share_of_error());
  }
  if (lux.empty() || shares.empty()) return {};
  std::sort(lux.begin(), lux.end());
  std::sort(shares.begin(), shares.end());
  const std::string range =
      fmt::format("{:.3g} to {:.3g} lx at {} places, half of them known to {:.1f} % or better, the worst to {:.1f} %",
                  lux.front(), lux.back(), lux.size(), 100 * shares[shares.size() / 2], 100 * shares.back());
  std::string html = fmt::format(
      "<h2>The light where camera \"{}\" sees it</h2>\n<p>Lamps only, under {}: {}. Between the places the light is "
      "traced in the room as it was found. Black: no matt surface.</p>\n",
      escaped_for_markup(map.camera), escaped_for_markup(map.light), range);
  html += picture_of(map.lux_png, fmt::format("Lux as camera \"{}\" sees the room: {}", map.camera, range));
  html += picture_of(map.error_png, "Standard error of that light, in percent of it");
  html +=
      "<details><summary>The places</summary>\n<div class=\"wide\">\n<table><tr><th>place</th><th>light</th><th>±, of "
      "it</th></tr>\n";
  for (const LuxMap::Place& place : map.places)
    html += fmt::format("<tr><td>{}</td><td>{:.1f} ± {:.1f} lx</td><td>{}</td></tr>\n", place_words(place),
                        place.light.lux, place.light.standard_error_lx,
                        place.light.lux > 0 ? fmt::format("{:.1f} %", 100 * place.light.share_of_error()) : "");
  return html + "</table>\n</div></details>\n";
}

std::string budget_section(const CalibrationReport& report) {
  if (!report.variance) return {};
  double squares = 0, goals = 0;
  for (const auto& goal : report.goals)
    if (goal.found.lux > 0) squares += std::pow(goal.found.share_of_error(), 2), ++goals;
  const double rms = goals > 0 ? std::sqrt(squares / goals) : 0;
  std::string html = fmt::format(
      "<h2>What the rest of the error is owed to</h2>\n<p>At the goals it is {:.1f} % of their light, root mean "
      "square.</p>\n<div class=\"wide\">\n<table class=\"words\"><tr><th>owed to</th><th>share of the variance</th>"
      "<th>alone it would be</th></tr>\n",
      100 * rms);
  for (const CameraBudgetPart& part : kCameraBudgetParts) {
    const double share = std::max(0.0, *report.variance.*part.share);
    html += fmt::format("<tr><td>{}</td><td>{:.1f} %</td><td>± {:.1f} %</td></tr>\n", escaped_for_markup(part.words),
                        100 * share, 100 * rms * std::sqrt(share));
  }
  return html + "</table>\n</div>\n";
}

std::string overflow_words(const CameraOverflow& overflow) {
  return fmt::format(
      "<p>Too bright for the shortest exposure: {:.2f} % of the pixels. {} of {} times that a place was to be read it "
      "was left out for that.</p>\n",
      100 * overflow.pixel_share, overflow.full_places, overflow.places);
}

/// To so many digits; what rounds to 0 has no sign.
double rounded(double value, int digits) {
  const double scale = std::pow(10, digits);
  return std::round(value * scale) / scale + 0.0;
}

std::string row(const char* what, const Known& known, const char* unit, int digits) {
  return fmt::format("<tr><td>{}</td><td>{:.{}f} ± {:.{}f}{}</td></tr>\n", what, rounded(known.value, digits), digits,
                     known.standard_error, digits, unit);
}

std::string row(const char* what, const Vec3& value, const Vec3& error, const char* unit, int digits) {
  return fmt::format("<tr><td>{}</td><td>{:.{}f} ± {:.{}f}{}</td></tr>\n", what, value.norm(), digits, error.norm(),
                     digits, unit);
}

std::string camera_table(const CalibratedCamera& camera) {
  std::string html = "<div class=\"wide\">\n<table class=\"words\"><tr><th>of the camera</th><th>as found</th></tr>\n";
  html += row("off the rig file's place", 100 * camera.offset_m, 100 * camera.offset_error_m, " cm", 1);
  html += row("turned", camera.turn_deg, camera.turn_error_deg, "°", 2);
  html += row("field of view, top to bottom", camera.fov_deg, "°", 2);
  html += row("distortion", camera.distortion, "", 4);
  // In a corner all three powers are 1.
  double log_loss = 0;
  for (const Known& part : camera.lens_loss) log_loss += part.value;
  html += fmt::format("<tr><td>shown in a corner, of what is shown in the middle</td><td>{:.0f} %</td></tr>\n",
                      100 * std::exp(-log_loss));
  std::string parts;
  for (const Known& part : camera.lens_loss)
    parts += fmt::format("{}{:.2f} ± {:.2f}", parts.empty() ? "" : ", ", rounded(part.value, 2), part.standard_error);
  html += fmt::format("<tr><td>its lens: a, b, c of e<sup>-(a ρ² + b ρ⁴ + c ρ⁶)</sup></td><td>{}</td></tr>\n", parts);
  const auto percent = [](const Known& share) { return Known{100 * share.value, 100 * share.standard_error}; };
  html += row("stray light over the picture", percent(camera.flare), " %", 1);
  html += row("stray light around each pixel", percent(camera.halo), " %", 1);
  for (const auto& [luminaire, response] : camera.responses)
    html += fmt::format("<tr><td>shows over the light of {}</td><td>{:.3g} ± {:.2g}</td></tr>\n",
                        escaped_for_markup(luminaire), response.value, response.standard_error);
  return html + "</table>\n</div>\n";
}

}  // namespace

std::string camera_section(const CalibrationReport& report) {
  std::string html = budget_section(report);
  for (const LuxMap& map : report.maps) html += map_section(map);
  for (const CalibrationReport::SeenBy& seen : report.seen) {
    html += fmt::format("<h2>Camera \"{}\"</h2>\n", escaped_for_markup(seen.camera));
    for (const CalibratedCamera& camera : report.found.cameras)
      if (camera.name == seen.camera) html += camera_table(camera);
    html += overflow_words(seen.overflow);
  }
  return html;
}

}  // namespace luxrig
