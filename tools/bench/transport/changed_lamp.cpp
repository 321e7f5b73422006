/// One lamp of a rig moves in a fixed scene: the cost of its new light at all receivers, at equal error. The cache and
/// incremental columns keep the parts that depend on scene and receivers; paths have nothing to keep. (A lamp that is
/// only dimmed costs nothing with any method: its column is multiplied.)

#include <fmt/format.h>

#include <cmath>

#include "core/transport/candidates/incremental_transport.h"
#include "tools/bench/cache/radiance_cache.h"
#include "tools/bench/transport/moved.h"

namespace luxrig {
namespace {

constexpr double kChangedLampError = 0.03, kChangedLampTimesFaster = 5;
/// A run longer than this is the last of its method: finer ones would each take several times as long.
constexpr double kLongestSeconds = 10;

/// The lamp 40 cm to a side with free space; unmoved if there is no such side.
Emitter hung_elsewhere(const TransportCase& one, std::size_t lamp) {
  Emitter moved = one.room.emitters[lamp];
  const Vec3 at_m = moved.world_from_lamp.translation_m;
  for (const Vec3& side : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(-1, 0, 0), Vec3(0, -1, 0)})
    if (!one.rays.occluded(at_m, Vec3::Zero(), at_m + 0.6 * side)) {
      moved.world_from_lamp.translation_m += 0.4 * side;
      break;
    }
  return moved;
}

/// One way to compute a lamp's column, at one setting.
struct ColumnWay {
  std::function<Result<TransportMatrix>(const Emitter&, std::uint64_t seed)> column;
  std::optional<double> wanted;
  std::string setting;
  CallSeconds built;  ///< once for scene and receivers
};
/// The ways of a method from coarse to fine; nothing after the finest.
struct ColumnMethod {
  std::string name;
  std::function<std::optional<ColumnWay>(std::size_t step)> way;
};

ColumnMethod sampled(const Method& method, const TransportCase& one, const BenchOptions& options) {
  return {method.name, [&method, &one, &options](std::size_t step) -> std::optional<ColumnWay> {
            constexpr double kWanted[] = {1, 0.7, 0.5, 0.35, 0.25, 0.18, 0.13, 0.09, 0.065, 0.045, 0.03, 0.02};
            if (step >= std::size(kWanted)) return std::nullopt;
            const double wanted = kWanted[step];
            return ColumnWay{[&method, &one, &options, wanted](const Emitter& lamp, std::uint64_t seed) {
                               EvaluateOptions evaluate;
                               evaluate.wanted_relative_error = wanted;
                               evaluate.seed = seed;
                               evaluate.threads = options.threads;
                               return method.make(one.rays)->evaluate(one.room.receivers, std::span(&lamp, 1),
                                                                      evaluate);
                             },
                             wanted,
                             {},
                             {}};
          }};
}

ColumnMethod cached(const TransportCase& one, const BenchOptions& options) {
  return {"cache", [&one, &options](std::size_t step) -> std::optional<ColumnWay> {
            constexpr int kGatherRays[] = {4096, 4096, 16384, 16384, 65536, 65536},
                          kLightSamples[] = {256, 1024, 1024, 4096, 8192, 32768};
            if (step >= std::size(kGatherRays)) return std::nullopt;
            CacheSettings settings;
            settings.gather_rays = kGatherRays[step];
            settings.light_samples = kLightSamples[step];
            RadianceCache::BuildOptions build;
            build.threads = options.threads;
            Result<RadianceCache> built = tl::unexpected(Fault{});
            const CallSeconds took = timed(
                [&] { built = RadianceCache::build(one.room.scene, one.rays, one.room.receivers, settings, build); });
            if (!built) return std::nullopt;
            const auto cache = std::make_shared<RadianceCache>(std::move(*built));
            return ColumnWay{[cache, &options](const Emitter& lamp, std::uint64_t) {
                               EvaluateOptions evaluate;
                               evaluate.threads = options.threads;
                               return cache->evaluate(std::span(&lamp, 1), evaluate);
                             },
                             std::nullopt,
                             fmt::format("{} gather rays; {} light samples; {:.0f} MB", settings.gather_rays,
                                         settings.light_samples, static_cast<double>(cache->report().bytes) / 1e6),
                             took};
          }};
}

ColumnMethod incremental(const TransportCase& one, const BenchOptions& options) {
  return {
      "incremental", [&one, &options](std::size_t step) -> std::optional<ColumnWay> {
        constexpr std::uint32_t kRays[] = {1024, 4096, 16384, 65536};
        if (step >= std::size(kRays)) return std::nullopt;
        IncrementalOptions settings;
        settings.rays_per_column = kRays[step];
        settings.threads = options.threads;
        Result<std::unique_ptr<IncrementalTransport>> made = tl::unexpected(Fault{});
        const CallSeconds took =
            timed([&] { made = IncrementalTransport::make(one.room.scene, one.rays, one.room.receivers, settings); });
        if (!made) return std::nullopt;
        const std::shared_ptr<IncrementalTransport> transport = std::move(*made);
        return ColumnWay{[transport](const Emitter& lamp, std::uint64_t) -> Result<TransportMatrix> {
                           const auto column = transport->column(lamp);
                           if (!column) return tl::unexpected(column.error());
                           TransportMatrix matrix;
                           matrix.lux_per_level = column->total_lux;
                           matrix.direct_lux_per_level = column->direct_lux;
                           matrix.rays = column->rays;
                           matrix.relative_error = (column->standard_error_lux.array() /
                                                    column->total_lux.array().max(1e-3 * column->total_lux.maxCoeff()))
                                                       .maxCoeff();
                           return matrix;
                         },
                         std::nullopt,
                         fmt::format("{} rays per column; {:.0f} MB", settings.rays_per_column,
                                     static_cast<double>(transport->bytes()) / 1e6),
                         took};
      }};
}

/// Medians of three runs, separately for error and times.
struct ColumnCost {
  RoomError error;
  Measured run;
  std::optional<double> wanted;
  std::string note;
};

ColumnCost cost_of(const ColumnWay& way, const Emitter& lamp, const Reference& reference, const BenchOptions& options) {
  ColumnCost cost;
  std::vector<CallSeconds> took;
  std::vector<double> rms, bias;
  for (std::uint64_t seed = 1; seed <= (options.quick ? 1u : 3u); ++seed) {
    Result<TransportMatrix> column = TransportMatrix{};
    took.push_back(timed([&] { column = way.column(lamp, seed); }));
    if (!column) {
      cost.run.refused = column.error().detail;
      return cost;
    }
    const RoomError error = error_of(column->lux(Eigen::VectorXd::Ones(1)), reference.lux, kFloorOfColumn);
    rms.push_back(error.rms), bias.push_back(error.bias);
    cost.run.matrix = std::move(*column);
  }
  const CallSeconds middle = median_of(took);
  cost.run.seconds = middle.wall;
  cost.run.cpu_seconds = middle.cpu;
  cost.error = {median_of(rms), median_of(bias)};
  cost.wanted = way.wanted;
  if (!way.setting.empty())
    cost.note = fmt::format("{}; built once in {:.3g} s ({:.3g} s of cpu)", way.setting, way.built.wall, way.built.cpu);
  return cost;
}

void add_changed_lamp(LitRoom lit, const BenchOptions& options, std::vector<BenchRow>& rows) {
  const std::string name = "changed-lamp-" + lit.name;
  TransportCase one(std::move(lit));
  const std::size_t count = one.room.emitters.size();
  std::vector<std::size_t> numbers = {count / 2};
  if (!options.quick && count >= 3) numbers = {0, count / 2, count - 1};
  std::vector<Emitter> lamps;
  for (const std::size_t lamp : numbers) lamps.push_back(hung_elsewhere(one, lamp));
  std::vector<Reference> references;
  for (std::size_t k = 0; k < lamps.size(); ++k) {
    references.push_back(column_reference(one, numbers[k], lamps[k], options));
    if (!references.back().refused.empty()) return;
  }
  std::vector<ColumnMethod> all = {cached(one, options), incremental(one, options)};
  for (const Method& method : methods())
    if (method.reflects) all.push_back(sampled(method, one, options));
  // For each method and lamp the first setting, from coarse to fine, that is good enough; else the best.
  std::vector<std::vector<ColumnCost>> found;
  for (const ColumnMethod& method : all) {
    std::vector<std::optional<ColumnCost>> best(lamps.size());
    double longest = 0;
    for (std::size_t step = 0; longest <= kLongestSeconds; ++step) {
      bool enough = true;
      for (const auto& cost : best) enough = enough && cost && cost->error.rms <= kChangedLampError;
      if (enough) break;
      const auto way = method.way(step);
      if (!way) break;
      for (std::size_t k = 0; k < lamps.size(); ++k) {
        if (best[k] && best[k]->error.rms <= kChangedLampError) continue;
        ColumnCost cost = cost_of(*way, lamps[k], references[k], options);
        longest = std::max(longest, cost.run.cpu_seconds);
        if (!best[k] || cost.error.rms < best[k]->error.rms) best[k] = std::move(cost);
      }
    }
    auto& of_method = found.emplace_back();
    for (std::size_t k = 0; k < lamps.size(); ++k) {
      of_method.push_back(best[k].value_or(ColumnCost{}));
      const ColumnCost& cost = of_method.back();
      rows.push_back(transport_row(fmt::format("{}-{}", name, numbers[k]), method.name, cost.error.rms, cost.run,
                                   cost.wanted, std::nullopt, cost.error, references[k].rms_error));
      if (cost.run.refused.empty()) set_note(rows.back(), cost.note);
    }
  }
  // The cache compared with the others: medians over the lamps.
  const auto median = [&](std::size_t method, auto&& value) {
    std::vector<double> values;
    for (std::size_t k = 0; k < lamps.size(); ++k) values.push_back(value(found[method][k], found[0][k]));
    return median_of(std::move(values));
  };
  Measured run;
  run.seconds = median(0, [](const ColumnCost& cost, const ColumnCost&) { return cost.run.seconds; });
  run.cpu_seconds = median(0, [](const ColumnCost& cost, const ColumnCost&) { return cost.run.cpu_seconds; });
  std::string note = fmt::format("medians of {} lamps", lamps.size());
  double path_seconds = 0, worst = 0;
  for (const ColumnCost& cost : found[0]) worst = std::max(worst, cost.error.rms);
  for (std::size_t m = 1; m < all.size(); ++m) {
    note +=
        fmt::format("; {} takes {:.3g} times as long ({:.3g} in cpu)", all[m].name,
                    median(m, [](const ColumnCost& a, const ColumnCost& b) { return a.run.seconds / b.run.seconds; }),
                    median(m, [](const ColumnCost& a, const ColumnCost& b) {
                      return a.run.cpu_seconds / std::max(1e-6, b.run.cpu_seconds);
                    }));
    if (all[m].name == "path")
      path_seconds = median(m, [](const ColumnCost& cost, const ColumnCost&) { return cost.run.seconds; });
  }
  rows.push_back(transport_row(name + "-to-0.03", "cache", worst, run, std::nullopt, kChangedLampError));
  rows.back().target_seconds = path_seconds / kChangedLampTimesFaster;
  set_note(rows.back(), note);
}

}  // namespace

void add_changed_lamp_rows(const BenchOptions& options, std::vector<BenchRow>& rows) {
  if (options.quick) {
    if (wanted_case(options, "changed-lamp-box")) add_changed_lamp(make_box_room(), options, rows);
    return;
  }
  if (wanted_case(options, "changed-lamp-flat")) add_changed_lamp(make_eight_room_flat(), options, rows);
  if (wanted_case(options, "changed-lamp-gallery")) add_changed_lamp(make_gallery_hall(), options, rows);
}

}  // namespace luxrig
