/// Savings from the skips of the evaluators in each room, and how far they move the answer: direct light against a
/// shadow ray for every pair, luminaires with size against sampling every pair, and unused cells of the cache.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/transport/direct/direct_sources.h"
#include "tools/bench/cache/radiance_cache.h"
#include "tools/bench/transport/case.h"

namespace luxrig {
namespace {

/// Median of some runs, for calls that take milliseconds; in one thread, so that neither side waits for other threads.
CallSeconds median_time(const BenchOptions& options, const std::function<void()>& call) {
  std::vector<CallSeconds> took;
  for (int i = 0; i < (options.quick ? 1 : 7); ++i) took.push_back(timed(call));
  return median_of(took);
}

BenchRow skip_row(const std::string& name, const char* method, double error, double target, const CallSeconds& with,
                  const CallSeconds& without, std::uint64_t rays, std::uint64_t rays_without, const std::string& what) {
  Measured run;
  run.seconds = with.wall;
  run.cpu_seconds = with.cpu;
  run.matrix.rays = rays;
  BenchRow row = transport_row(name, method, error, run, std::nullopt, target);
  set_note(row, fmt::format("{}; without it {:.3g} s ({:.3g} s of cpu; {:.2f} times); {} rays instead of {}", what,
                            without.wall, without.cpu, without.cpu / std::max(1e-9, with.cpu), rays_without, rays));
  return row;
}

/// A shadow ray for each pair of receiver and lamp, then the distance law: nothing is checked beforehand.
void add_direct(const TransportCase& one, const BenchOptions& options, std::vector<BenchRow>& rows) {
  const auto& receivers = one.room.receivers;
  const auto& lamps = one.room.emitters;
  for (const Emitter& lamp : lamps)
    if (lamp.sky || lamp.shape.kind != LuminousShape::Kind::point) return;
  EvaluateOptions evaluate;
  evaluate.threads = 1;
  Result<TransportMatrix> got = TransportMatrix{};
  const CallSeconds with =
      median_time(options, [&] { got = make_direct_evaluator(one.rays)->evaluate(receivers, lamps, evaluate); });
  if (!got) return;
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(got->receivers(), got->emitters());
  std::uint64_t behind = 0, dark = 0;
  const CallSeconds without = median_time(options, [&] {
    behind = dark = 0;
    for (Eigen::Index r = 0; r < all.rows(); ++r)
      for (Eigen::Index e = 0; e < all.cols(); ++e) {
        const Receiver& receiver = receivers[static_cast<std::size_t>(r)];
        const Emitter& lamp = lamps[static_cast<std::size_t>(e)];
        const Vec3& at_m = lamp.world_from_lamp.translation_m;
        const bool seen = !one.rays.occluded(receiver.position_world_m, receiver.normal_world, at_m);
        const Vec3 towards_m = at_m - receiver.position_world_m;
        const double distance_m = towards_m.norm(), cosine = receiver.normal_world.dot(towards_m) / distance_m;
        const double candela =
            lamp.intensity->intensity_cd(lamp.world_from_lamp.inverse_direction(-towards_m / distance_m));
        behind += !(cosine > 0);
        dark += cosine > 0 && !(candela > 0);
        all(r, e) = seen && cosine > 0 ? candela * cosine / (distance_m * distance_m) : 0;
      }
  });
  const auto pairs = static_cast<std::uint64_t>(all.size());
  rows.push_back(skip_row("skip-" + one.room.name + "-direct-evaluator", "direct",
                          (all - got->lux_per_level).cwiseAbs().maxCoeff() / all.maxCoeff(), 1e-9, with, without,
                          got->rays, pairs, fmt::format("of {} pairs {} behind and {} dark", pairs, behind, dark)));
}

/// The room's lamps as disks of 30 cm, with 256 sample rays from each receiver to each lamp. With proofs, a pair proven
/// clear takes no ray and one proven blocked takes one ray to a corner. The samples are the same, so the light must be
/// the same.
void add_proofs(const TransportCase& one, const BenchOptions& options, std::vector<BenchRow>& rows) {
  std::vector<Emitter> disks = one.room.emitters;
  for (Emitter& disk : disks) {
    if (disk.sky) return;
    disk.shape = {LuminousShape::Kind::disk, Vec3::Constant(0.3)};
  }
  const auto& receivers = one.room.receivers;
  const DirectSources sources(disks);
  DirectSources::Scratch scratch;
  constexpr std::uint32_t kRays = 256;
  std::uint64_t ways = 0, clear = 0, blocked = 0, rays[2] = {0, 0};
  Eigen::MatrixXd lux[2];
  const auto sample_all = [&](bool prove) {
    Eigen::MatrixXd& all = lux[prove] =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(receivers.size()), static_cast<Eigen::Index>(disks.size()));
    ways = clear = blocked = rays[prove] = 0;
    for (std::size_t r = 0; r < receivers.size(); ++r)
      for (std::size_t e = 0; e < disks.size(); ++e) {
        if (!sources.may_light(e, receivers[r])) continue;
        ++ways;
        const Way way = prove ? way_between(one.rays, receivers[r], disks[e], rays[1]) : Way::unknown;
        clear += way == Way::clear;
        blocked += way == Way::blocked;
        if (way == Way::blocked) continue;
        const DirectSum sum = sample_direct(one.rays, receivers[r], disks[e], way, SkyOpenings(),
                                            SobolSequence(mixed(7, r * disks.size() + e)), 0, kRays, scratch);
        rays[prove] += sum.rays;
        for (const DirectSum::Part& part : sum.parts)
          all(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(e)) += part.lux / kRays;
      }
  };
  sample_all(true);  // the first proof builds a tree
  const CallSeconds without = median_time(options, [&] { sample_all(false); }),
                    with = median_time(options, [&] { sample_all(true); });
  const double scale = lux[0].maxCoeff();
  if (!(scale > 0)) return;
  rows.push_back(skip_row("skip-" + one.room.name + "-proven-ways", "direct",
                          (lux[1] - lux[0]).cwiseAbs().maxCoeff() / scale, 1e-9, with, without, rays[1], rays[0],
                          fmt::format("of {} ways {} proven clear and {} blocked", ways, clear, blocked)));
}

/// Leaves out cells that no receiver needs.
void add_cells(const TransportCase& one, const BenchOptions& options, std::vector<BenchRow>& rows) {
  struct Cached {
    CallSeconds took;
    CacheReport report;
    TransportMatrix matrix;
  };
  const auto run = [&](bool only_needed) -> std::optional<Cached> {
    CacheSettings settings;
    settings.only_needed = only_needed;
    if (options.quick) settings.voxels = 64, settings.gather_rays = settings.light_samples = 512;
    RadianceCache::BuildOptions build;
    build.threads = options.threads;
    EvaluateOptions evaluate;
    evaluate.threads = options.threads;
    Cached of;
    std::optional<RadianceCache> cache;
    of.took = timed([&] {
      if (auto built = RadianceCache::build(one.room.scene, one.rays, one.room.receivers, settings, build))
        cache.emplace(std::move(*built));
    });
    if (!cache) return std::nullopt;
    auto matrix = cache->evaluate(one.room.emitters, evaluate);
    if (!matrix) return std::nullopt;
    of.report = cache->report();
    of.matrix = std::move(*matrix);
    return of;
  };
  const auto with = run(true), without = run(false);
  if (!with || !without) return;
  const Eigen::VectorXd levels = Eigen::VectorXd::Ones(with->matrix.emitters());
  const Eigen::ArrayXd lux = with->matrix.lux(levels).array(), other = without->matrix.lux(levels).array(),
                       bar = with->matrix.standard_error_lux(levels).array();
  const double scale = std::max(1e-300, bar.square().sum());
  BenchRow row =
      skip_row("skip-" + one.room.name + "-cache-cells", "cache", std::sqrt((lux - other).square().sum() / scale), 1.0,
               with->took, without->took, with->report.rays, without->report.rays,
               fmt::format("{} cells instead of {}; {:.3g} MB instead of {:.3g}; error in standard errors stated",
                           with->report.cells, without->report.cells, static_cast<double>(with->report.bytes) / 1e6,
                           static_cast<double>(without->report.bytes) / 1e6));
  rows.push_back(std::move(row));
}

}  // namespace

void add_evaluator_skip_rows(const BenchOptions& options, std::vector<BenchRow>& rows) {
  for (const auto make : {+[] { return make_box_room(); }, +[] { return make_eight_room_flat(); },
                          +[] { return make_gallery_hall(); }, +[] { return make_atrium(); }}) {
    const TransportCase one(make());
    const std::string name = "skip-" + one.room.name;
    if (options.quick && one.room.name != "box") continue;
    if (wanted_case(options, name + "-direct-evaluator")) add_direct(one, options, rows);
    if (wanted_case(options, name + "-proven-ways")) add_proofs(one, options, rows);
    if (wanted_case(options, name + "-cache-cells")) add_cells(one, options, rows);
  }
}

}  // namespace luxrig
