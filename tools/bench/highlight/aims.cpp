/// Heads on a ring above an object, aimed: compared with all aimed at its middle, and with random aims.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "core/check.h"
#include "core/highlight/aim/aim_heads.h"
#include "tools/bench/highlight/rows.h"

namespace luxrig {
namespace {

constexpr int kRandomLooks = 200;
constexpr double kAimTarget_s = 3;
constexpr double kSpotLumens = 2000, kSpotExponent = 60;  // half of the maximum 12° off axis
/// Radius and height of the ring, as multiples of the object's diagonal.
constexpr double kRingRadius = 2, kRingHeight = 1.2;

std::vector<HangingHead> ring_of_heads(const ReliefStudy& study, int count) {
  Vec3 middle_m = Vec3::Zero();
  for (const OrientedPoint& point : study.points)
    middle_m += point.position_world_m / static_cast<double>(study.points.size());
  const double diagonal_m = study.surface.diagonal_m();
  std::vector<HangingHead> heads;
  for (int i = 0; i < count; ++i) {
    const double angle_rad = 2 * kPi * (i + 0.25) / count;
    HangingHead head;
    head.world_from_mount.translation_m =
        middle_m + diagonal_m * Vec3(kRingRadius * std::cos(angle_rad), kRingRadius * std::sin(angle_rad), kRingHeight);
    head.zoom = {{make_cosine_power(kSpotLumens, kSpotExponent)}};
    heads.push_back(std::move(head));
  }
  return heads;
}

HeadSetting towards(const HangingHead& head, const Vec3& aim_world_m, double level) {
  const auto joints = pan_tilt_towards(head.world_from_mount, aim_world_m - head.world_from_mount.translation_m,
                                       head.range, head.present);
  return joints ? HeadSetting{*joints, 0, level} : HeadSetting{head.present, 0, 0};
}

}  // namespace

void add_aim_rows(HighlightObject& object, const BenchOptions& options, std::vector<BenchRow>& rows) {
  for (const int count : {3, 8}) {
    const std::string name = fmt::format("aims-{}-{}", object.name(), count);
    if (!highlight_wanted(options, name)) continue;
    ReliefStudyOptions of_study = options_of_study(options);
    of_study.interest.max_points = std::min(of_study.interest.max_points, kAimPoints);
    const auto studied = study_relief(object.scene(), of_study);
    LUXRIG_CHECK(studied, "{}", studied.error().detail);
    const ReliefStudy& study = *studied;
    const RayScene room(object.scene());
    const std::vector<HangingHead> heads = ring_of_heads(study, count);
    AimOptions how;
    how.threads = options.threads;
    std::optional<AimResult> found;
    std::optional<HeadAims> aims;
    ContrastSamples samples;
    const CallSeconds took = timed([&] {
      samples = one_ring_samples(study.surface, study.interest);
      auto made = HeadAims::make(samples, study.features, room, heads, {}, how);
      LUXRIG_CHECK(made, "{}", made.error().detail);
      aims = std::move(*made);
      auto solved = aims->solve();
      LUXRIG_CHECK(solved, "{}", solved.error().detail);
      found = std::move(*solved);
    });
    Vec3 middle_m = Vec3::Zero();
    for (const OrientedPoint& point : study.points)
      middle_m += point.position_world_m / static_cast<double>(study.points.size());
    std::vector<HeadSetting> on_middle;
    for (const HangingHead& head : heads) on_middle.push_back(towards(head, middle_m, 1));
    const AimScore plain = aims->score(on_middle);
    AimScore best_random;
    best_random.objective = -std::numeric_limits<double>::infinity();
    std::mt19937_64 random(static_cast<std::uint64_t>(count));
    std::uniform_int_distribution<std::size_t> any(0, study.points.size() - 1);
    std::uniform_real_distribution<double> level(0, 1);
    for (int look = 0; look < kRandomLooks; ++look) {
      std::vector<HeadSetting> settings;
      for (const HangingHead& head : heads) {
        const Vec3& aim_m = study.points[any(random)].position_world_m;
        settings.push_back(towards(head, aim_m, level(random)));
      }
      AimScore score = aims->score(settings);
      if (score.objective > best_random.objective) best_random = std::move(score);
    }
    const double best = std::max({found->score.objective, plain.objective, best_random.objective});
    const auto add = [&](const char* method, const AimScore& score, const CallSeconds& seconds, const char* note) {
      HighlightRow row{name, method, 1 - score.objective / best, seconds, {}, {}, {}, {}, note};
      row.shown = ShownRelief{heads.size(), std::nan(""), score.local_contrast_lx, score.coverage};
      if (std::string_view(method) == "luxrig" && count == 8) row.target_seconds = kAimTarget_s;
      rows.push_back(bench_row_of(row));
    };
    add("luxrig", found->score, took, "from the features on; error: of the objective below the best of the three");
    add("middle", plain, {}, "every head on the middle at full level");
    add("random", best_random, {}, "best of 200: any interest point and level");
  }
}

}  // namespace luxrig
