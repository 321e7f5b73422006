#include "core/highlight/seen/seen_contrast.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace luxrig {
namespace {

constexpr std::size_t kLevels = 4, kFineLevels = 2;
/// Angle that an object takes when it is looked at as a whole.
constexpr double kObjectWide_deg = 10;
/// Middle of the finest level's band [cycles/pixel]; each next level has half.
constexpr double kBandMiddle = 0.2;
/// Contrast that counts as a half where sensitivity is highest.
constexpr double kHalfContrast = 0.06;
/// Contrast that counts as a half at the outline.
constexpr float kHalfOutline = 0.1f;

/// Neighbours face alike within this angle.
const double kAlikeCosine = std::cos(rad_from_deg(20));
/// At a shadow's edge a light falls to this share. Where it is below that share of its mean, it casts none that shows.
constexpr float kInShadow = 0.3f;
/// Contrast that counts as a half at such an edge.
constexpr float kHalfShadow = 0.1f;

/// Mannos and Sakrison's sensitivity, over its maximum near 8 cycles/degree.
double contrast_sensitivity(double cycles_per_degree) {
  const double f = cycles_per_degree;
  return 2.6 * (0.0192 + 0.114 * f) * std::exp(-std::pow(0.114 * f, 1.1));
}

/// Blurs by (1 4 6 4 1)/16 in both directions; nothing comes from outside.
void blur(std::span<const float> from, int width, int height, std::vector<float>& rows, std::vector<float>& to) {
  const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
  rows.resize(from.size());
  to.resize(from.size());
  const auto sum = [](float a, float b, float c, float d, float e) {
    return 0.0625f * (a + e) + 0.25f * (b + d) + 0.375f * c;
  };
  for (std::size_t y = 0; y < h; ++y) {
    const float* in = &from[y * w];
    float* out = &rows[y * w];
    const auto at = [&](std::size_t x, int by) {
      const auto i = static_cast<std::ptrdiff_t>(x) + by;
      return i < 0 || i >= static_cast<std::ptrdiff_t>(w) ? 0.0f : in[i];
    };
    for (const std::size_t x : {std::size_t{0}, std::size_t{1}, w - 2, w - 1})
      out[x] = sum(at(x, -2), at(x, -1), at(x, 0), at(x, 1), at(x, 2));
    for (std::size_t x = 2; x + 2 < w; ++x) out[x] = sum(in[x - 2], in[x - 1], in[x], in[x + 1], in[x + 2]);
  }
  const std::vector<float> none(w, 0.0f);
  const auto row = [&](std::size_t y, int by) {
    const auto i = static_cast<std::ptrdiff_t>(y) + by;
    return i < 0 || i >= static_cast<std::ptrdiff_t>(h) ? none.data() : &rows[static_cast<std::size_t>(i) * w];
  };
  for (std::size_t y = 0; y < h; ++y) {
    const float *a = row(y, -2), *b = row(y, -1), *c = row(y, 0), *d = row(y, 1), *e = row(y, 2);
    for (std::size_t x = 0; x < w; ++x) to[y * w + x] = sum(a[x], b[x], c[x], d[x], e[x]);
  }
}

/// Every second pixel of every second row.
void halve(std::span<const float> from, int width, int height, std::vector<float>& to) {
  to.clear();
  for (int y = 0; y < height; y += 2)
    for (int x = 0; x < width; x += 2) to.push_back(from[static_cast<std::size_t>(y * width + x)]);
}

int half_of(int size) { return (size + 1) / 2; }

float over(float value) { return value > 1e-3f ? 1 / value : 0; }

}  // namespace

SeenContrast::SeenContrast(std::vector<SeenView> views, const SeenWishes& wishes) : wishes_(wishes) {
  LUXRIG_CHECK(!views.empty(), "no view");
  for (SeenView& seen : views) {
    LUXRIG_CHECK(seen.object_samples > 0 && seen.object_samples <= seen.samples.size() &&
                     seen.reflectance.size() == seen.samples.size() && seen.width_px >= 8 && seen.height_px >= 8,
                 "{} of {} samples", seen.object_samples, seen.samples.size());
    View view;
    view.first_sample = samples_.size();
    view.seen = std::move(seen);
    const SeenView& of = view.seen;
    samples_.insert(samples_.end(), of.samples.begin(), of.samples.end());
    reflectance_.insert(reflectance_.end(), of.reflectance.begin(), of.reflectance.end());
    for (std::size_t s = 0; s < of.samples.size(); ++s) of_object_.push_back(s < of.object_samples ? 1 : 0);
    object_samples_ += static_cast<double>(of.object_samples);
    for (std::size_t s = 0; s < of.object_samples; ++s) reflectance_sum_ += of.reflectance[s];
    const auto w = static_cast<std::size_t>(of.width_px);
    for (std::size_t p = 0; p < of.sample_of_pixel.size(); ++p) {
      if (!of.of_object(p)) continue;
      const auto beside = [&](bool there, std::size_t q) {
        if (there && !of.of_object(q)) view.outline.emplace_back(of.sample_of_pixel[p], of.sample_of_pixel[q]);
      };
      beside(p % w > 0, p - 1);
      beside(p % w + 1 < w, p + 1);
      beside(p >= w, p - w);
      beside(p + w < of.sample_of_pixel.size(), p + w);
      const auto alike = [&](bool there, std::size_t q) {
        if (!there || !of.of_object(q)) return;
        const std::uint32_t a = of.sample_of_pixel[p], b = of.sample_of_pixel[q];
        const auto first = static_cast<std::uint32_t>(view.first_sample);
        if (of.samples[a].normal.dot(of.samples[b].normal) > kAlikeCosine)
          view.alike.emplace_back(first + a, first + b);
      };
      alike(p % w + 1 < w, p + 1);
      alike(p + w < of.sample_of_pixel.size(), p + w);
    }
    add_levels(view);
    views_.push_back(std::move(view));
  }
}

std::vector<std::uint32_t> SeenContrast::outline() const {
  std::vector<std::uint32_t> along;
  for (const View& view : views_)
    for (const auto& [inside, outside] : view.outline)
      if (const auto sample = static_cast<std::uint32_t>(view.first_sample) + inside;
          along.empty() || along.back() != sample)
        along.push_back(sample);
  return along;
}

void SeenContrast::add_levels(View& view) const {
  const SeenView& seen = view.seen;
  int width = seen.width_px, height = seen.height_px;
  const double object_px = std::sqrt(static_cast<double>(seen.object_samples));
  std::vector<float> mask(seen.sample_of_pixel.size(), 0), rows, blurred_mask;
  std::array<std::vector<float>, 3> normal, blurred;  // times the mask
  for (auto& one : normal) one.assign(mask.size(), 0);
  for (std::size_t p = 0; p < mask.size(); ++p) {
    if (!seen.of_object(p)) continue;
    mask[p] = 1;
    for (int a = 0; a < 3; ++a)
      normal[static_cast<std::size_t>(a)][p] = static_cast<float>(seen.samples[seen.sample_of_pixel[p]].normal[a]);
  }
  for (std::size_t k = 0; k < kLevels; ++k) {
    Level level{width, height, {}, {}, {}, 1};
    blur(mask, width, height, rows, blurred_mask);
    for (std::size_t a = 0; a < 3; ++a) blur(normal[a], width, height, rows, blurred[a]);
    double sum = 0;
    for (std::size_t p = 0; p < mask.size(); ++p) {
      level.over_mask.push_back(over(mask[p]));
      level.over_blurred_mask.push_back(level.over_mask[p] > 0 ? over(blurred_mask[p]) : 0);
      double form2 = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        const double c = normal[a][p] * level.over_mask[p] - blurred[a][p] * level.over_blurred_mask[p];
        form2 += c * c;
      }
      const double form = std::sqrt(form2);
      level.weight.push_back(form > 1e-5 ? mask[p] * static_cast<float>(form) : 0);  // below: rounding of a flat place
      sum += level.weight.back();
    }
    for (float& one : level.weight) one = sum > 0 ? one / static_cast<float>(sum) : 0;
    const double cycles_per_object = kBandMiddle * object_px / static_cast<double>(1 << k);
    level.half_contrast = static_cast<float>(kHalfContrast / contrast_sensitivity(cycles_per_object / kObjectWide_deg));
    view.levels.push_back(std::move(level));
    halve(blurred_mask, width, height, mask);
    for (std::size_t a = 0; a < 3; ++a) halve(blurred[a], width, height, normal[a]);
    width = half_of(width);
    height = half_of(height);
    if (width < 4 || height < 4) break;
  }
}

double SeenContrast::second_shadows(std::span<const float> lux, std::span<const std::vector<float>> lights) const {
  double all = 0, most = 0;
  for (const std::vector<float>& light : lights) {
    LUXRIG_CHECK(light.size() == samples_.size(), "{} for {} samples", light.size(), samples_.size());
    double sum = 0, edges = 0;
    for (std::size_t i = 0; i < light.size(); ++i) sum += of_object_[i] ? light[i] : 0;
    const auto least = kInShadow * static_cast<float>(sum / object_samples_);
    for (const View& view : views_)
      for (const auto& [a, b] : view.alike) {
        const auto [low, high] = std::minmax(light[a], light[b]);
        if (!(high > least) || low > kInShadow * high) continue;
        const float c = (high - low) / (lux[a] + lux[b]);
        edges += c / (c + kHalfShadow);
      }
    all += edges;
    most = std::max(most, edges);
  }
  const double width_px = std::sqrt(object_samples_ / static_cast<double>(views_.size()));
  return std::min(1.0, (all - most) / (width_px * static_cast<double>(views_.size())));
}

SeenScore SeenContrast::score(std::span<const float> lux, double darkest_lx,
                              std::span<const std::vector<float>> lights) const {
  LUXRIG_CHECK(lux.size() == samples_.size(), "{} for {} samples", lux.size(), samples_.size());
  SeenScore score;
  std::vector<float> response(lux.size());  // first the luminance, times π
  double sum = 0;
  for (std::size_t i = 0; i < lux.size(); ++i) {
    response[i] = reflectance_[i] * lux[i];
    sum += of_object_[i] ? response[i] : 0;
  }
  score.mean_lx = reflectance_sum_ > 0 ? sum / reflectance_sum_ : 0;
  const double mean = std::max(sum, darkest_lx * reflectance_sum_) / object_samples_;
  if (mean > 0) {
    const auto over_mean = static_cast<float>(1 / mean);
    double lit = 0, lux_sum = 0;
    for (std::size_t i = 0; i < lux.size(); ++i) lux_sum += of_object_[i] ? lux[i] : 0;
    const auto mean_lx = static_cast<float>(std::max(lux_sum / object_samples_, darkest_lx));
    std::size_t burnt = 0, crushed = 0;
    constexpr auto kBurnt = static_cast<float>(kBurntOverMean), kCrushed = static_cast<float>(kCrushedOverMean),
                   kOverRamp = static_cast<float>(1 / (kLitOverMean - kCrushedOverMean));
    for (std::size_t i = 0; i < lux.size(); ++i) {
      const float x = response[i] * over_mean;
      response[i] = x / (x + 1);
      if (!of_object_[i]) continue;
      burnt += x > kBurnt ? 1 : 0;
      crushed += x < kCrushed ? 1 : 0;
      lit += std::clamp((x - kCrushed) * kOverRamp, 0.0f, 1.0f);
      score.even += 2 * lux[i] / (lux[i] + mean_lx);
    }
    score.burnt_share = static_cast<double>(burnt) / object_samples_;
    score.crushed_share = static_cast<double>(crushed) / object_samples_;
    score.lit_share = lit / object_samples_;
    score.even /= object_samples_;
    if (wishes_.shadows_weight > 0) score.shadows = second_shadows(lux, lights);
    for (const View& view : views_)
      score_view(view, std::span(response).subspan(view.first_sample, view.seen.samples.size()), score);
  } else {
    score.crushed_share = 1;
  }
  const double clipped = score.burnt_share + score.crushed_share - wishes_.max_clipped;
  score.objective = wishes_.fine_weight * score.fine + wishes_.form_weight * score.form +
                    wishes_.lit_weight * score.lit_share + wishes_.edge_weight * score.edge +
                    wishes_.even_weight * score.even - wishes_.shadows_weight * score.shadows -
                    wishes_.clipped_weight * std::max(0.0, clipped);
  return score;
}

void SeenContrast::score_view(const View& view, std::span<const float> response, SeenScore& score) const {
  const double of_views = 1 / static_cast<double>(views_.size());
  std::vector<float> picture(view.seen.sample_of_pixel.size(), 0), rows, blurred;
  for (std::size_t p = 0; p < picture.size(); ++p)
    if (view.seen.of_object(p)) picture[p] = response[view.seen.sample_of_pixel[p]];
  for (std::size_t k = 0; k < view.levels.size(); ++k) {
    const Level& level = view.levels[k];
    blur(picture, level.width_px, level.height_px, rows, blurred);
    float sum = 0;
    for (std::size_t p = 0; p < picture.size(); ++p) {
      const float c = std::abs(picture[p] * level.over_mask[p] - blurred[p] * level.over_blurred_mask[p]);
      sum += level.weight[p] * c / (c + level.half_contrast);
    }
    const std::size_t of_group = k < kFineLevels ? kFineLevels : kLevels - kFineLevels;
    (k < kFineLevels ? score.fine : score.form) += of_views * sum / static_cast<double>(of_group);
    halve(blurred, level.width_px, level.height_px, picture);
  }
  double outline = 0;
  for (const auto& [inside, outside] : view.outline) {
    const float c = std::abs(response[inside] - (outside == SeenView::kNothing ? 0.0f : response[outside]));
    outline += c / (c + kHalfOutline);
  }
  if (!view.outline.empty()) score.edge += of_views * outline / static_cast<double>(view.outline.size());
}

}  // namespace luxrig
