#include "core/radiometry/sample_curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/check.h"

namespace luxrig {
namespace {

constexpr int kCurvePoints = 2049;  // straight lines between this many are off by less than 1e-6 of full scale
constexpr std::size_t kCurveSlices = 1024;
constexpr std::size_t kMaxCurvePoints = 70'000;
constexpr std::string_view kCurveHead = "sample,light";

double light_of_srgb(double x) { return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4); }
double light_of_bt709(double x) { return x < 0.081 ? x / 4.5 : std::pow((x + 0.099) / 1.099, 1 / 0.45); }

template <class LightOf>
std::vector<std::pair<double, double>> points_of(double dark_share, const LightOf& light_of) {
  LUXRIG_CHECK(dark_share >= 0 && dark_share < 1, "dark level {}", dark_share);
  std::vector<std::pair<double, double>> points;
  for (int i = 0; i < kCurvePoints; ++i) {
    const double x = static_cast<double>(i) / (kCurvePoints - 1);
    points.emplace_back(dark_share + (1 - dark_share) * x, light_of(x));
  }
  return points;
}

bool read_curve_number(std::string_view text, double& out) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

SampleCurve::SampleCurve(std::vector<std::pair<double, double>> points) : points_(std::move(points)) {
  const double first = points_.front().first, width = points_.back().first - first;
  std::size_t at = 0;
  for (std::size_t i = 0; i < kCurveSlices; ++i) {
    const double from = first + width * static_cast<double>(i) / kCurveSlices;
    while (at + 2 < points_.size() && points_[at + 1].first <= from) ++at;
    first_segment_.push_back(at);
  }
}

SampleCurve SampleCurve::linear(double dark_share) {
  LUXRIG_CHECK(dark_share >= 0 && dark_share < 1, "dark level {}", dark_share);
  return SampleCurve({{dark_share, 0}, {1, 1}});
}
SampleCurve SampleCurve::srgb(double dark_share) { return SampleCurve(points_of(dark_share, light_of_srgb)); }
SampleCurve SampleCurve::bt709(double dark_share) { return SampleCurve(points_of(dark_share, light_of_bt709)); }
SampleCurve SampleCurve::power(double exponent, double dark_share) {
  return SampleCurve(points_of(dark_share, [exponent](double x) { return std::pow(x, exponent); }));
}

Result<SampleCurve> SampleCurve::through(std::vector<std::pair<double, double>> points) {
  if (points.size() < 2) return refusal("a response curve needs two points at least");
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& [sample, light] = points[i];
    if (!std::isfinite(sample) || !std::isfinite(light) || sample < 0 || sample > 1 || std::abs(light) > 1e6)
      return refusal(fmt::format("point {} of a response curve is ({}, {})", i + 1, sample, light));
    if (i > 0 && (sample - points[i - 1].first < 1e-9 || light < points[i - 1].second))
      return refusal(fmt::format("a response curve does not rise at its point {}", i + 1));
  }
  if (!(points.back().second > points.front().second)) return refusal("a response curve does not rise");
  return SampleCurve(std::move(points));
}

std::size_t SampleCurve::segment(double sample) const {
  const double first = points_.front().first, width = points_.back().first - first;
  const double slice = std::clamp((sample - first) / width * kCurveSlices, 0.0, static_cast<double>(kCurveSlices - 1));
  std::size_t at = first_segment_[static_cast<std::size_t>(slice)];
  while (at + 2 < points_.size() && points_[at + 1].first <= sample) ++at;
  return at;
}

double SampleCurve::slope(double sample) const {
  const std::size_t at = segment(sample);
  return (points_[at + 1].second - points_[at].second) / (points_[at + 1].first - points_[at].first);
}

double SampleCurve::light(double sample) const {
  const std::size_t at = segment(sample);
  return points_[at].second + slope(sample) * (sample - points_[at].first);
}

std::string to_csv(const SampleCurve& curve) {
  std::string text(kCurveHead);
  for (const auto& [sample, light] : curve.points()) text += fmt::format("\n{:.9g},{:.9g}", sample, light);
  return text + "\n";
}

Result<SampleCurve> sample_curve_from_csv(std::string_view text) {
  std::vector<std::pair<double, double>> points;
  for (int line = 1; !text.empty(); ++line) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view row = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (row.ends_with('\r')) row.remove_suffix(1);
    if (line == 1) {
      if (row != kCurveHead) return refusal(fmt::format("line 1 of a response curve is not \"{}\"", kCurveHead));
      continue;
    }
    if (row.empty()) continue;
    const std::size_t comma = row.find(',');
    double sample = 0, light = 0;
    if (comma == std::string_view::npos || !read_curve_number(row.substr(0, comma), sample) ||
        !read_curve_number(row.substr(comma + 1), light))
      return refusal(fmt::format("line {} of a response curve has no two numbers", line));
    if (points.size() >= kMaxCurvePoints) return refusal("a response curve has too many points");
    points.emplace_back(sample, light);
  }
  return SampleCurve::through(std::move(points));
}

}  // namespace luxrig
