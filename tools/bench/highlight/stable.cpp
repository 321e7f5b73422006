/// How far chosen lights move when the same object comes in another form.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/check.h"
#include "core/highlight/distant/relief_lights.h"
#include "tools/bench/highlight/rows.h"
#include "tools/bench/highlight/variants.h"

namespace luxrig {
namespace {

constexpr double kStableWithin_rad = rad_from_deg(5);

/// A direction that a person might prefer for the light; of the object in its original form.
const Vec3 kWantedFrom(-0.5, -0.6, 0.6);

/// One and two lights.
struct ChosenLights {
  std::vector<Vec3> one, two;
};

ChosenLights chosen_lights(const ReliefStudy& study, const Vec3& preferred, int threads) {
  ReliefLightOptions options;
  options.threads = threads;
  options.preferred = preferred;
  const auto search = ReliefLightSearch::make(study.surface, study.rays, study.interest, options);
  LUXRIG_CHECK(search, "{}", search.error().detail);
  return {search->lights(1)->directions, search->lights(2)->directions};
}

/// Largest angle between two sets of lights, in their best matching.
double moved_rad(const std::vector<Vec3>& before, std::vector<Vec3> after) {
  if (before.size() != after.size()) return kPi;
  std::vector<std::size_t> order(after.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  double min_rad = kPi;
  do {
    double worst_rad = 0;
    for (std::size_t k = 0; k < order.size(); ++k)
      worst_rad =
          std::max(worst_rad, std::atan2(before[k].cross(after[order[k]]).norm(), before[k].dot(after[order[k]])));
    min_rad = std::min(min_rad, worst_rad);
  } while (std::next_permutation(order.begin(), order.end()));
  return min_rad;
}

}  // namespace

void add_stable_rows(HighlightObject& object, const BenchOptions& options, std::vector<BenchRow>& rows) {
  struct Wish {
    const char* suffix;
    Vec3 preferred;
    std::optional<ChosenLights> before = {};
  };
  std::array<Wish, 2> wishes = {Wish{"", Vec3::Zero()}, Wish{"-preferred", kWantedFrom}};
  for (const char* kind : highlight_variant_kinds()) {
    const std::string name = fmt::format("stable-{}-{}", object.name(), kind);
    if (!highlight_wanted(options, name)) continue;
    const ReliefStudy& study = object.study();
    const HighlightVariant variant = highlight_variant(object.scene(), kind);
    const auto changed = study_relief(variant.scene, options_of_study(options));
    LUXRIG_CHECK(changed, "{}: {}", name, changed.error().detail);
    for (Wish& wish : wishes) {
      if (!wish.before) wish.before = chosen_lights(study, wish.preferred, options.threads);
      ChosenLights after;
      const CallSeconds took =
          timed([&] { after = chosen_lights(*changed, variant.rotation * wish.preferred, options.threads); });
      for (const auto& [was, is] :
           {std::pair(&wish.before->one, &after.one), std::pair(&wish.before->two, &after.two)}) {
        std::vector<Vec3> back;
        for (const Vec3& direction : *is) back.push_back(variant.rotation.transpose() * direction);
        const double rad = moved_rad(*was, back);
        HighlightRow row{name, fmt::format("{}-lights{}", was->size(), wish.suffix)};
        row.error = rad / kPi;
        row.took = took;
        row.target_error = kStableWithin_rad / kPi;
        row.shown = shown_relief(study, back, options.threads);
        const double was_lx = shown_relief(study, *was, options.threads).local_contrast_lx;
        row.note =
            fmt::format("moved {:.1f} deg; on the object itself {:.1f} % of the contrast; {} triangles",
                        deg_from_rad(rad), 100 * row.shown->local_contrast_lx / was_lx, variant.scene.triangles.size());
        rows.push_back(bench_row_of(row));
      }
    }
  }
}

}  // namespace luxrig
