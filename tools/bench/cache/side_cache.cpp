/// CacheContents::sides. B_p is the radiosity of the first reflection of side p. G_rp is the share of receiver r's
/// hemisphere (cosine-weighted) that shows p. The first reflection is Σ G_rp B_p. Later ones are exchanged between
/// groups of sides (side_exchange.h) and read with the same G, summed by group.

#include <fmt/format.h>

#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "core/transport/bsdf.h"
#include "core/transport/progress.h"
#include "tools/bench/cache/cache_method.h"
#include "tools/bench/cache/light_view.h"
#include "tools/bench/cache/seen_part.h"
#include "tools/bench/cache/side_exchange.h"
#include "tools/bench/cache/volume/voxelise.h"

namespace luxrig {
namespace {

constexpr std::uint64_t kGatherSamples = 0x676174686572, kSideLightSamples = 0x6c69676874,
                        kBrightSamples = 0x627269676874;
constexpr std::size_t kSideReplicates = kCacheReplicates;
/// The thinnest walls to expect, as a share of the covered part of the scene.
constexpr double kMinWall = 0.01;

/// A side is bright for an emitter if it reflects at least this share of all that the emitter's light reflects.
constexpr double kBrightShare = 1.0 / 256;
/// If this many of a receiver's rays hit a side, they measure its form factor well enough.
constexpr double kRaysThatMeasure = 64;
/// The most unknowns for which later reflections are solved in advance, and the most numbers kept then.
constexpr std::size_t kMaxSolvedRows = 2048, kMaxSolvedReads = 20'000'000;
/// With cells n times as large the error of resolution is n times as large or more, so this share of the difference
/// between both belongs to the finer one. Later reflections use the larger cells in both, which the difference does not
/// show. Measured in the rooms of `luxrig bench transport`: twice the share covers both.
[[nodiscard]] double share_of_difference(int group_cells) { return 1.0 / std::max(1, group_cells - 1); }

/// Radiosity of one side's first reflection of one emitter.
struct SideLight {
  std::uint32_t side;
  Eigen::Matrix<float, kSideReplicates, 1> of_replicate[3];  ///< [lm/m²], per channel
};

class SideCache final : public RadianceCache::Method {
 public:
  SideCache(const Scene& scene, const RayScene& ray_scene, std::span<const Receiver> points,
            const Eigen::AlignedBox3d& part_m, const CacheSettings& settings,
            const RadianceCache::BuildOptions& options)
      : settings_(settings),
        seed_(options.seed),
        channels_(all_grey(scene) ? 1 : 3),
        sides_(scene, ray_scene, VoxelGrid::around(part_m, settings.voxels).coarser(settings.reduction),
               settings.group_cells, options.threads) {
    rays = &ray_scene;
    receivers.assign(points.begin(), points.end());
    materials_ = scene.materials;
    material_of_triangle_ = scene.material_of_triangle;
    rays_per_replicate_ = static_cast<std::uint32_t>(
        (static_cast<std::size_t>(settings.gather_rays) + kSideReplicates - 1) / kSideReplicates);
  }

  /// False when stopped.
  bool build(const Scene& scene, const RadianceCache::BuildOptions& options) {
    if (!gather(options)) return false;
    std::vector<bool> seen(sides_.groups(), false);
    for (std::size_t side = 0; side < sides_.sides(); ++side)
      if (first_read_[side] < first_read_[side + 1]) seen[sides_.group_of_side(side)] = true;
    exchange_ = std::make_unique<SideExchange>(scene, *rays, sides_, std::move(seen), settings_.only_needed,
                                               settings_.reflections, settings_.group_rays, channels_, options.seed,
                                               options.threads, options.watch.stop);
    if (options.watch.stop.stop_requested()) return false;
    read_groups();
    if (exchange_->rows() > 0 && exchange_->rows() <= kMaxSolvedRows &&
        exchange_->rows() * receivers.size() <= kMaxSolvedReads) {
      const Eigen::MatrixXf reads(group_reads_);
      reads_of_later_.resize(static_cast<std::size_t>(channels_));
      parallel_for(reads_of_later_.size(), options.threads,
                   [&](std::size_t c) { reads_of_later_[c] = exchange_->reads_of_later(reads, static_cast<int>(c)); });
    }
    return !options.watch.stop.stop_requested();
  }

  std::optional<ReflectedLight> reflected(std::span<const Emitter> emitters,
                                          const EvaluateOptions& options) const override {
    const auto n = static_cast<Eigen::Index>(receivers.size()), m = static_cast<Eigen::Index>(emitters.size());
    ReflectedLight light;
    light.lux_per_level.assign(static_cast<std::size_t>(channels_), Eigen::MatrixXd::Zero(n, m));
    light.replicates.assign(kSideReplicates, Eigen::MatrixXd::Zero(n, m));
    light.coarser = Eigen::MatrixXd::Zero(n, m);
    light.share_of_difference = share_of_difference(settings_.group_cells);
    const std::size_t tasks = emitters.size() * kSideReplicates;
    std::vector<std::vector<std::pair<std::uint32_t, Eigen::Vector3f>>> falls(tasks);
    std::vector<std::uint64_t> cast(tasks + emitters.size() * kSideReplicates, 0);
    CallingThreadProgress progress(options.watch, 0.5, 1, tasks);
    parallel_for(tasks, options.threads, [&](std::size_t task) {
      if (options.watch.stop.stop_requested()) return;
      falls[task] = first_reflection(emitters[task / kSideReplicates], task % kSideReplicates, cast[task]);
    });
    std::vector<std::vector<SideLight>> sides_light(emitters.size());
    std::vector<ByGroups> later(emitters.size());
    parallel_for(emitters.size(), options.threads, [&](std::size_t e) {
      sides_light[e] = merged(std::span(falls).subspan(e * kSideReplicates, kSideReplicates));
      later[e] = by_groups(sides_light[e]);
    });
    // Receivers in blocks, so that one emitter alone keeps all threads busy.
    const std::size_t blocks = std::clamp<std::size_t>(receivers.size() / 32, 1, kSideReplicates);
    parallel_for(emitters.size() * blocks, options.threads, [&](std::size_t task) {
      if (options.watch.stop.stop_requested()) return;
      const std::size_t e = task / blocks, block = task % blocks;
      const std::size_t begin = receivers.size() * block / blocks, end = receivers.size() * (block + 1) / blocks;
      cast[tasks + task] = read(sides_light[e], later[e], begin, end, static_cast<Eigen::Index>(e), light);
      progress.one_done();
    });
    if (options.watch.stop.stop_requested()) return std::nullopt;
    light.rays = std::accumulate(cast.begin(), cast.end(), std::uint64_t{0});
    return light;
  }

  CacheReport report() const override {
    CacheReport report;
    for (std::size_t side = 0; side < sides_.sides(); ++side)
      report.cells += exchange_->row_of_group(sides_.group_of_side(side)) != SurfaceSides::kNone;
    report.cells_near_surfaces = sides_.sides();
    report.links = reads_.size() + exchange_->links();
    report.rays = cast_ + exchange_->rays();
    report.bytes = sides_.bytes() + exchange_->bytes() + reads_.size() * sizeof(Read) +
                   first_read_.size() * sizeof(std::size_t) +
                   static_cast<std::size_t>(group_reads_.nonZeros()) * (sizeof(float) + sizeof(int));
    for (const auto& reads : reads_of_later_) report.bytes += static_cast<std::size_t>(reads.size()) * sizeof(float);
    return report;
  }

 private:
  /// Share of a receiver's hemisphere that shows a side, by the rays of one replicate.
  struct Read {
    std::uint32_t receiver;
    std::uint32_t replicate;
    float share;
  };

  /// Traces rays from the receivers and finds the sides that they hit.
  bool gather(const RadianceCache::BuildOptions& options) {
    struct Met {
      std::uint32_t side, replicate;
      float share;
    };
    std::vector<std::vector<Met>> met(receivers.size());
    std::vector<std::uint64_t> cast(receivers.size(), 0);
    CallingThreadProgress progress(options.watch, 0, 0.4, receivers.size());
    parallel_for(receivers.size(), options.threads, [&](std::size_t r) {
      const Receiver& receiver = receivers[r];
      std::vector<std::uint32_t> sides;
      for (std::uint32_t k = 0; k < kSideReplicates; ++k) {
        if (options.watch.stop.stop_requested()) return;
        const SobolSequence samples(mixed(mixed(mixed(options.seed, kGatherSamples), r), k));
        sides.clear();
        for (std::uint32_t i = 0; i < rays_per_replicate_; ++i) {
          const auto [u, v] = samples.pair(i, 0, 0);
          ++cast[r];
          const auto hit = rays->nearest(receiver.position_world_m, cosine_direction(receiver.normal_world, u, v),
                                         receiver.normal_world);
          if (!hit) continue;
          const std::uint32_t side = sides_.side_at(hit->position_world_m, hit->normal_world, cast[r]);
          if (side != SurfaceSides::kNone) sides.push_back(side);
        }
        std::sort(sides.begin(), sides.end());
        for (std::size_t a = 0; a < sides.size();) {
          std::size_t b = a;
          while (b < sides.size() && sides[b] == sides[a]) ++b;
          met[r].push_back({sides[a], k, static_cast<float>(b - a) / static_cast<float>(rays_per_replicate_)});
          a = b;
        }
      }
      progress.one_done();
    });
    if (options.watch.stop.stop_requested()) return false;
    cast_ = std::accumulate(cast.begin(), cast.end(), std::uint64_t{0});
    // Ordered by side: light that falls on few sides then needs few of them.
    first_read_.assign(sides_.sides() + 1, 0);
    for (const auto& list : met)
      for (const Met& one : list) ++first_read_[one.side + 1];
    std::partial_sum(first_read_.begin(), first_read_.end(), first_read_.begin());
    std::vector<std::size_t> next(first_read_.begin(), first_read_.end() - 1);
    reads_.resize(first_read_.back());
    for (std::uint32_t r = 0; r < met.size(); ++r)
      for (const Met& one : met[r]) reads_[next[one.side]++] = {r, one.replicate, one.share};
    return true;
  }

  void read_groups() {
    std::vector<Eigen::Triplet<float>> triplets;
    triplets.reserve(reads_.size());
    for (std::size_t side = 0; side < sides_.sides(); ++side) {
      const std::uint32_t row = exchange_->row_of_group(sides_.group_of_side(side));
      for (std::size_t i = first_read_[side]; i < first_read_[side + 1]; ++i)
        triplets.emplace_back(static_cast<int>(reads_[i].receiver), static_cast<int>(row),
                              reads_[i].share / static_cast<float>(kSideReplicates));
    }
    group_reads_.resize(static_cast<Eigen::Index>(receivers.size()), static_cast<Eigen::Index>(exchange_->rows()));
    group_reads_.setFromTriplets(triplets.begin(), triplets.end());
  }

  /// Radiosity that the emitter's first hits leave on sides, by side.
  std::vector<std::pair<std::uint32_t, Eigen::Vector3f>> first_reflection(const Emitter& emitter, std::size_t replicate,
                                                                          std::uint64_t& cast) const {
    const SobolSequence samples(mixed(mixed(seed_, kSideLightSamples), replicate));
    const auto count = static_cast<std::uint32_t>(
        (static_cast<std::size_t>(settings_.light_samples) + kSideReplicates - 1) / kSideReplicates);
    const LightView view = light_view(*rays, emitter, samples, count);
    cast += view.rays;
    std::vector<std::pair<std::uint32_t, Eigen::Vector3f>> falls;
    for (const LightViewHit& hit : view.hits) {
      const std::uint32_t side = sides_.side_at(hit.position_world_m, hit.normal_world, cast);
      if (side == SurfaceSides::kNone || exchange_->row_of_group(sides_.group_of_side(side)) == SurfaceSides::kNone)
        continue;
      Vec3 radiosity = hit.flux_lm / sides_.area_of_side_m2(side) *
                       diffuse_equivalent_rgb(materials_[material_of_triangle_[hit.triangle]]);
      if (channels_ == 3) radiosity = radiosity.cwiseProduct(emitter.colour_rgb);
      falls.emplace_back(side, radiosity.cast<float>());
    }
    std::stable_sort(falls.begin(), falls.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    return falls;
  }

  /// The radiosities of all replicates together, one entry per side.
  std::vector<SideLight> merged(std::span<const std::vector<std::pair<std::uint32_t, Eigen::Vector3f>>> falls) const {
    std::vector<std::uint32_t> sides;
    for (const auto& list : falls)
      for (const auto& [side, radiosity] : list) sides.push_back(side);
    std::sort(sides.begin(), sides.end());
    sides.erase(std::unique(sides.begin(), sides.end()), sides.end());
    std::vector<SideLight> light(sides.size());
    for (std::size_t i = 0; i < sides.size(); ++i) {
      light[i].side = sides[i];
      for (auto& channel : light[i].of_replicate) channel.setZero();
    }
    for (std::size_t k = 0; k < falls.size(); ++k) {
      std::size_t i = 0;
      for (const auto& [side, radiosity] : falls[k]) {
        while (light[i].side < side) ++i;
        for (int c = 0; c < channels_; ++c) light[i].of_replicate[c][static_cast<Eigen::Index>(k)] += radiosity[c];
      }
    }
    return light;
  }

  [[nodiscard]] double luminance(const Vec3& channels) const {
    return channels_ == 1 ? channels[0] : channels.dot(kLuminanceOfRgb);
  }

  /// The light of one emitter at all receivers through groups.
  struct ByGroups {
    Eigen::VectorXd of_channel[3];   ///< reflections after the first
    Eigen::VectorXd luminance;       ///< the same
    Eigen::VectorXd first_by_group;  ///< luminance of the first reflection, if it were stored in groups
  };
  ByGroups by_groups(const std::vector<SideLight>& light) const {
    const auto n = static_cast<Eigen::Index>(receivers.size());
    ByGroups out;
    out.luminance = out.first_by_group = Eigen::VectorXd::Zero(n);
    for (int c = 0; c < channels_; ++c) {
      Eigen::VectorXd groups = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(exchange_->rows()));
      for (const SideLight& side : light) {
        const std::uint32_t group = sides_.group_of_side(side.side);
        groups[exchange_->row_of_group(group)] += static_cast<double>(side.of_replicate[c].mean()) *
                                                  sides_.area_of_side_m2(side.side) / sides_.area_of_group_m2(group);
      }
      const auto channel = static_cast<std::size_t>(c);
      if (!reads_of_later_.empty())
        out.of_channel[c] = (reads_of_later_[channel] * groups.cast<float>()).cast<double>();
      else
        out.of_channel[c] = (group_reads_ * exchange_->later(groups, c).cast<float>()).cast<double>();
      const double weight = channels_ == 1 ? 1.0 : kLuminanceOfRgb[c];
      out.luminance += weight * out.of_channel[c];
      out.first_by_group += weight * (group_reads_ * groups.cast<float>()).cast<double>();
    }
    return out;
  }

  /// The light of one emitter at receivers [begin, end). Returns the number of shadow rays.
  std::uint64_t read(const std::vector<SideLight>& light, const ByGroups& later, std::size_t begin, std::size_t end,
                     Eigen::Index emitter, ReflectedLight& out) const {
    std::uint64_t cast = 0;
    const auto n = static_cast<Eigen::Index>(end - begin);
    using Estimates = Eigen::Matrix<double, Eigen::Dynamic, kSideReplicates, Eigen::RowMajor>;
    Estimates own = Estimates::Zero(n, kSideReplicates);  // G of replicate k, B of replicate k
    Eigen::Matrix<double, Eigen::Dynamic, 3> all =
        Eigen::Matrix<double, Eigen::Dynamic, 3>::Zero(n, 3);  // means of both
    Vec3 whole_lm = Vec3::Zero();
    for (const SideLight& side : light)
      for (int c = 0; c < channels_; ++c)
        whole_lm[c] += static_cast<double>(side.of_replicate[c].mean()) * sides_.area_of_side_m2(side.side);
    std::vector<bool> measured(static_cast<std::size_t>(n), false);
    for (const SideLight& side : light) {
      const double area_m2 = sides_.area_of_side_m2(side.side);
      Vec3 sum = Vec3::Zero();
      Eigen::Matrix<double, kSideReplicates, 1> of_replicate = Eigen::Matrix<double, kSideReplicates, 1>::Zero();
      for (int c = 0; c < channels_; ++c) {
        const Eigen::Matrix<double, kSideReplicates, 1> lm_m2 = side.of_replicate[c].cast<double>();
        sum[c] = lm_m2.mean();
        of_replicate += (channels_ == 1 ? 1.0 : kLuminanceOfRgb[c]) * lm_m2;
      }
      const bool bright = settings_.bright_sides && luminance(sum) * area_m2 >= kBrightShare * luminance(whole_lm);
      if (bright) cast += read_bright(side.side, begin, end, sum, of_replicate, measured, own, all);
      for (std::size_t i = first_read_[side.side]; i < first_read_[side.side + 1]; ++i) {
        const Read& entry = reads_[i];
        if (entry.receiver < begin || entry.receiver >= end) continue;
        const auto r = static_cast<Eigen::Index>(entry.receiver - begin);
        if (bright && measured[static_cast<std::size_t>(r)]) continue;
        own(r, entry.replicate) += static_cast<double>(entry.share) * of_replicate[entry.replicate];
        all.row(r) += static_cast<double>(entry.share) / kSideReplicates * sum.transpose();
      }
    }
    const auto first = static_cast<Eigen::Index>(begin);
    const Eigen::VectorXd added = later.luminance.segment(first, n);
    for (int c = 0; c < channels_; ++c)
      out.lux_per_level[static_cast<std::size_t>(c)].col(emitter).segment(first, n) =
          all.col(c) + later.of_channel[c].segment(first, n);
    for (std::size_t k = 0; k < kSideReplicates; ++k)
      out.replicates[k].col(emitter).segment(first, n) = own.col(static_cast<Eigen::Index>(k)) + added;
    out.coarser.col(emitter).segment(first, n) = later.first_by_group.segment(first, n) + added;
    return cast;
  }

  /// Reads one side by its form factor at a random place per replicate, with a shadow ray. Only for receivers whose
  /// rays would seldom hit it; `measured` says which.
  template <class Own, class All>
  std::uint64_t read_bright(std::uint32_t side, std::size_t begin, std::size_t end, const Vec3& sum,
                            const Eigen::Matrix<double, kSideReplicates, 1>& of_replicate, std::vector<bool>& measured,
                            Own& own, All& all) const {
    std::uint64_t cast = 0;
    const auto pieces = sides_.pieces_of_side(side);
    const double area_m2 = sides_.area_of_side_m2(side);
    const double max_rays = kRaysThatMeasure / (static_cast<double>(rays_per_replicate_) * kSideReplicates);
    for (std::size_t r = begin; r < end; ++r) {
      const Receiver& receiver = receivers[r];
      const auto share_of = [&](const SurfacePiece& piece) {
        const Vec3 way = piece.position_world_m - receiver.position_world_m;
        const double distance_squared = way.squaredNorm();
        const double cosines = receiver.normal_world.dot(way) * -piece.normal_world.template cast<double>().dot(way);
        const bool faces = receiver.normal_world.dot(way) > 0 && cosines > 0;
        return faces ? area_m2 * cosines / (kPi * distance_squared * distance_squared) : 0.0;
      };
      double most = 0;
      for (const SurfacePiece& piece : pieces) most = std::max(most, share_of(piece));
      const bool measure = most < max_rays;
      measured[r - begin] = measure;
      if (!measure || most == 0) continue;
      for (std::uint32_t k = 0; k < kSideReplicates; ++k) {
        // One random place per replicate, each in its own equal part of the area.
        const double jitter =
            static_cast<double>(mixed(mixed(mixed(seed_, kBrightSamples), r), side * kSideReplicates + k) >> 11) *
            0x1p-53;
        double left = (k + jitter) / kSideReplicates * area_m2;
        std::size_t i = 0;
        while (i + 1 < pieces.size() && left > static_cast<double>(pieces[i].area_m2))
          left -= static_cast<double>(pieces[i++].area_m2);
        const double share = share_of(pieces[i]);
        if (!(share > 0)) continue;
        ++cast;
        if (rays->occluded(receiver.position_world_m, receiver.normal_world, pieces[i].position_world_m)) continue;
        const auto row = static_cast<Eigen::Index>(r - begin);
        own(row, static_cast<Eigen::Index>(k)) += share * of_replicate[static_cast<Eigen::Index>(k)];
        all.row(row) += share / kSideReplicates * sum.transpose();
      }
    }
    return cast;
  }

  CacheSettings settings_;
  std::uint64_t seed_;
  int channels_;
  SurfaceSides sides_;
  std::vector<Material> materials_;
  std::vector<std::uint32_t> material_of_triangle_;
  std::uint32_t rays_per_replicate_ = 0;
  std::vector<Read> reads_;                      ///< ordered by side
  std::vector<std::size_t> first_read_;          ///< per side, and one more
  Eigen::SparseMatrix<float> group_reads_;       ///< receivers × rows of the exchange
  std::vector<Eigen::MatrixXf> reads_of_later_;  ///< per channel; empty = solved for each set of emitters
  std::unique_ptr<SideExchange> exchange_;
  std::uint64_t cast_ = 0;
};

}  // namespace

BuiltMethod build_side_cache(const Scene& scene, const RayScene& rays, std::span<const Receiver> receivers,
                             const CacheSettings& settings, const RadianceCache::BuildOptions& options) {
  const Eigen::AlignedBox3d part_m = seen_part_m(scene, rays, receivers, options.seed);
  if (!part_m.isEmpty()) {
    // The two sides of a wall are distinguished if it is thicker than this.
    const double min_wall_m = 6 * rays.surface_error_m(scene.origin_world_m + part_m.center());
    const double part_side_m = part_m.sizes().maxCoeff(), whole_side_m = triangle_bounds_m(scene).sizes().maxCoeff();
    if (min_wall_m > kMinWall * part_side_m)
      return refusal(fmt::format(
          "the radiance cache cannot tell both sides of a wall of {:.2g} m apart beside surfaces of {:.3g} m: choose "
          "the model path or gather, or leave out what lies far off",
          min_wall_m, whole_side_m));
  }
  auto cache = std::make_unique<SideCache>(scene, rays, receivers, part_m, settings, options);
  if (!cache->build(scene, options))
    return tl::unexpected(Fault{Cause::cancelled, "", "stopped while building the radiance cache", {}});
  return cache;
}

}  // namespace luxrig
