/// CacheContents::directions: the thesis's volumetric radiance cache (§3.2), with improvements.

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "core/transport/bsdf.h"
#include "core/transport/direct/direct_light.h"
#include "core/transport/progress.h"
#include "tools/bench/cache/cache_method.h"
#include "tools/bench/cache/direction_cells.h"
#include "tools/bench/cache/light_view.h"
#include "tools/bench/cache/radiance_field.h"

namespace luxrig {
namespace {

constexpr std::uint64_t kSeedOfReads = 0x7265616473, kSeedOfLight = 0x6c69676874, kSeedOfPlaces = 0x706c616365;
constexpr std::size_t kReplicates = kCacheReplicates;
/// Reflections are followed until one adds less than this share of the sum. Phantom surfaces can reflect more light
/// than they get (the thesis's own remark on eq. 3.10), so the number is limited, too.
constexpr double kNegligible = 1e-3;
constexpr int kMaxReflections = 24;

double unit_number(std::uint64_t key) { return static_cast<double>(key >> 11) * 0x1p-53; }

/// Radiance numbers by cell, one row each.
using Field = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

class DirectionCache final : public RadianceCache::Method {
 public:
  DirectionCache(const Scene& scene, const RayScene& ray_scene, std::span<const Receiver> points,
                 const CacheSettings& settings, const RadianceCache::BuildOptions& options)
      : settings_(settings),
        seed_(options.seed),
        grey_(all_grey(scene)),
        layout_(settings, grey_),
        cells_(scene, ray_scene, points, settings),
        materials_(scene.materials),
        material_of_triangle_(scene.material_of_triangle) {
    rays = &ray_scene;
    receivers.assign(points.begin(), points.end());
  }

  bool build(const Scene& scene, const RadianceCache::BuildOptions& options) {
    const bool gathers = settings_.reconstruction == Reconstruction::gather;
    if (!gathers || settings_.first_reflection == FirstReflection::cache) read_above();
    if (gathers) gather(scene, options);
    if (options.watch.stop.stop_requested()) return false;
    for (const Read& read : above_)
      mark(read.place, receivers[read.receiver].position_world_m, receivers[read.receiver].normal_world);
    for (const Gathered& one : gathered_) mark(one.place, one.position_world_m, one.normal_world);
    // With a gather, the gather makes the last reflection itself.
    const int reflections = settings_.reflections == 0 ? 0 : std::max(1, settings_.reflections - (gathers ? 1 : 0));
    cells_.link(scene, *rays, settings_, reflections, options.seed, options.threads, options.watch.stop);
    return !options.watch.stop.stop_requested();
  }

  std::optional<ReflectedLight> reflected(std::span<const Emitter> emitters,
                                          const EvaluateOptions& options) const override {
    const auto n = static_cast<Eigen::Index>(receivers.size()), m = static_cast<Eigen::Index>(emitters.size());
    ReflectedLight light;
    light.lux_per_level.assign(static_cast<std::size_t>(layout_.channels()), Eigen::MatrixXd::Zero(n, m));
    light.replicates.assign(kReplicates, Eigen::MatrixXd::Zero(n, m));
    light.coarser = Eigen::MatrixXd::Zero(n, m);
    light.share_of_difference = 1;  // cells twice as large
    CallingThreadProgress progress(options.watch, 0.5, 1, emitters.size());
    for (std::size_t e = 0; e < emitters.size(); ++e) {
      if (!one_emitter(emitters[e], static_cast<Eigen::Index>(e), options, light)) return std::nullopt;
      progress.one_done();
    }
    return light;
  }

  CacheReport report() const override {
    CacheReport report;
    for (std::size_t c = 0; c < cells_.size(); ++c) report.cells += cells_.needed(c);
    report.cells_near_surfaces = cells_.size();
    report.links = cells_.links();
    report.rays = cells_.rays() + cast_;
    report.bytes = cells_.bytes() + above_.size() * sizeof(Read) + gathered_.size() * sizeof(Gathered) +
                   report.cells * static_cast<std::size_t>(layout_.size()) * sizeof(float);
    return report;
  }

 private:
  struct CellPoint {
    DirectionCells::Shares shares;
    std::size_t count = 0;
  };
  /// A place above a receiver.
  struct Read {
    std::uint32_t receiver, replicate;
    CellPoint place;
  };
  /// A surface that a receiver's ray hits.
  struct Gathered {
    std::uint32_t receiver, replicate;
    Vec3 position_world_m;
    Vec3 normal_world;
    Vec3 reflectance_rgb;
    CellPoint place;
  };

  void mark(const CellPoint& place, const Vec3& surface_world_m, const Vec3& normal) {
    for (std::size_t i = 0; i < place.count; ++i)
      cells_.need(place.shares[i].cell, surface_world_m - cells_.origin_world_m(), normal);
  }
  [[nodiscard]] std::uint32_t per_replicate(int count) const {
    return static_cast<std::uint32_t>((static_cast<std::size_t>(count) + kReplicates - 1) / kReplicates);
  }

  /// Places on the hemisphere above each receiver, half a cell to a cell away.
  void read_above() {
    above_per_replicate_ = per_replicate(settings_.hemisphere_samples);
    for (std::uint32_t r = 0; r < receivers.size(); ++r)
      for (std::uint32_t k = 0; k < kReplicates; ++k) {
        const SobolSequence samples(mixed(mixed(mixed(seed_, kSeedOfReads), r), k));
        for (std::uint32_t i = 0; i < above_per_replicate_; ++i) {
          const auto [u, v, w, unused] = samples.set(i, 0);
          Read read{r, k, {}};
          const Vec3 at_m = receivers[r].position_world_m - cells_.origin_world_m() +
                            cells_.cell_m() * (0.5 + 0.5 * w) * cosine_direction(receivers[r].normal_world, u, v);
          read.place.count = cells_.shares_at(at_m, Vec3::Zero(), read.place.shares);
          above_.push_back(read);
        }
      }
  }

  void gather(const Scene& scene, const RadianceCache::BuildOptions& options) {
    gathered_per_replicate_ = per_replicate(settings_.gather_rays);
    std::vector<std::vector<Gathered>> met(receivers.size());
    parallel_for(receivers.size(), options.threads, [&](std::size_t r) {
      for (std::uint32_t k = 0; k < kReplicates && !options.watch.stop.stop_requested(); ++k) {
        const SobolSequence samples(mixed(mixed(mixed(seed_, ~kSeedOfReads), r), k));
        for (std::uint32_t i = 0; i < gathered_per_replicate_; ++i) {
          const auto [u, v] = samples.pair(i, 0, 0);
          const auto hit = rays->nearest(receivers[r].position_world_m,
                                         cosine_direction(receivers[r].normal_world, u, v), receivers[r].normal_world);
          if (!hit) continue;
          Gathered one{static_cast<std::uint32_t>(r),
                       k,
                       hit->position_world_m,
                       hit->normal_world,
                       diffuse_equivalent_rgb(scene.materials[scene.material_of_triangle[hit->triangle]]),
                       {}};
          const Vec3 before_m =
              hit->position_world_m - cells_.origin_world_m() + 0.5 * cells_.cell_m() * hit->normal_world;
          one.place.count = cells_.shares_at(before_m, hit->normal_world, one.place.shares);
          met[r].push_back(one);
        }
      }
    });
    for (auto& list : met) gathered_.insert(gathered_.end(), list.begin(), list.end());
    cast_ += static_cast<std::uint64_t>(gathered_per_replicate_) * kReplicates * receivers.size();
  }

  /// Light-view samples into cells (eq. 3.8), one field per replicate.
  std::vector<Field> first_bounce(const Emitter& emitter, const EvaluateOptions& options, std::uint64_t& cast) const {
    std::vector<LightView> views(kReplicates);
    parallel_for(kReplicates, options.threads, [&](std::size_t k) {
      views[k] = light_view(*rays, emitter, SobolSequence(mixed(mixed(seed_, kSeedOfLight), k)),
                            per_replicate(settings_.light_samples));
    });
    for (const LightView& view : views) cast += view.rays;
    std::vector<Field> fields(kReplicates, Field::Zero(static_cast<Eigen::Index>(cells_.size()), layout_.size()));
    std::vector<std::uint64_t> rays_of_cell(cells_.size(), 0);
    parallel_for(cells_.size(), options.threads, [&](std::size_t c) {
      if (!cells_.needed(c) || options.watch.stop.stop_requested()) return;
      std::uint64_t key = mixed(mixed(seed_, kSeedOfPlaces), c);
      for (std::size_t k = 0; k < kReplicates; ++k)
        for (const LightViewHit& hit : views[k].hits) {
          const double u = unit_number(key = mixed(seed_, key)), v = unit_number(key = mixed(seed_, key)),
                       w = unit_number(key = mixed(seed_, key)), jitter = unit_number(key = mixed(seed_, key));
          const Vec3 at_m = cells_.place_m(c, u, v, w), hit_m = hit.position_world_m - cells_.origin_world_m();
          const Vec3 way = hit_m - at_m;
          const double cosine = -way.dot(hit.normal_world);
          if (!(cosine > 0)) continue;
          // Places nearer than half a cell stand for the whole cell, whose light must not grow without bound.
          const double distance_m = way.norm(), min_m = 0.5 * cells_.cell_m();
          if (!cells_.visible(*rays, settings_, at_m, hit_m, jitter, rays_of_cell[c])) continue;
          const Vec3 rgb = hit.flux_lm / kPi * (cosine / distance_m) / std::pow(std::max(distance_m, min_m), 2) *
                           diffuse_equivalent_rgb(materials_[material_of_triangle_[hit.triangle]]);
          layout_.add(harmonics(way / distance_m), grey_ ? rgb : Vec3(rgb.cwiseProduct(emitter.colour_rgb)),
                      fields[k].row(static_cast<Eigen::Index>(c)));
        }
    });
    cast = std::accumulate(rays_of_cell.begin(), rays_of_cell.end(), cast);
    return fields;
  }

  /// One reflection from cell to cell (eq. 3.10).
  Field bounced(const Field& from, const EvaluateOptions& options) const {
    Field to = Field::Zero(from.rows(), from.cols());
    const double per_ray = 4.0 / settings_.link_rays;  // 4π / n · B / π
    parallel_for(cells_.size(), options.threads, [&](std::size_t c) {
      for (const DirectionCells::Link& link : cells_.links_of(c)) {
        const Vec3 lux = layout_.illuminance(from.row(link.from), cosine_lobe(link.normal_world.cast<double>()));
        layout_.add(harmonics(link.direction_world.cast<double>()),
                    per_ray * lux.cwiseMax(0.0).cwiseProduct(link.reflectance_rgb.cast<double>()),
                    to.row(static_cast<Eigen::Index>(c)));
      }
    });
    return to;
  }

  /// Each cell replaced by the mean of its block of 2³ cells.
  Field coarsened(const Field& field) const {
    std::vector<std::pair<std::array<int, 3>, std::size_t>> block(cells_.size());
    for (std::size_t c = 0; c < cells_.size(); ++c) {
      const Eigen::Vector3i& v = cells_.voxel(c);
      block[c] = {{v.z() / 2, v.y() / 2, v.x() / 2}, c};
    }
    std::sort(block.begin(), block.end());
    Field out = Field::Zero(field.rows(), field.cols());
    for (std::size_t a = 0, b = 0; a < block.size(); a = b) {
      Eigen::RowVectorXf sum = Eigen::RowVectorXf::Zero(field.cols());
      float count = 0;
      for (b = a; b < block.size() && block[b].first == block[a].first; ++b) {
        if (!cells_.needed(block[b].second)) continue;
        sum += field.row(static_cast<Eigen::Index>(block[b].second));
        ++count;
      }
      for (std::size_t i = a; i < b && count > 0; ++i)
        out.row(static_cast<Eigen::Index>(block[i].second)) = sum / count;
    }
    return out;
  }

  [[nodiscard]] Vec3 at(const Field& field, const CellPoint& place, const Harmonics& lobe) const {
    Eigen::RowVectorXf mixture = Eigen::RowVectorXf::Zero(field.cols());
    for (std::size_t i = 0; i < place.count; ++i) mixture += place.shares[i].weight * field.row(place.shares[i].cell);
    return layout_.illuminance(mixture, lobe);
  }

  /// Illuminance of the receivers per replicate: rows = receivers, columns = 3 · replicate + primary.
  using Estimates = Eigen::Matrix<double, Eigen::Dynamic, 3 * kReplicates>;

  void add_read(const std::vector<const Field*>& fields, Estimates& out) const {
    for (const Read& read : above_) {
      const Vec3 lux = at(*fields[read.replicate], read.place, cosine_lobe(receivers[read.receiver].normal_world));
      out.row(read.receiver).template segment<3>(3 * read.replicate) += lux.transpose() / above_per_replicate_;
    }
  }
  void add_gathered(const Field& field, Estimates& out) const {
    for (const Gathered& one : gathered_) {
      const Vec3 lux = at(field, one.place, cosine_lobe(one.normal_world)).cwiseMax(0.0);
      out.row(one.receiver).template segment<3>(3 * one.replicate) +=
          lux.cwiseProduct(one.reflectance_rgb).transpose() / gathered_per_replicate_;
    }
  }

  bool one_emitter(const Emitter& emitter, Eigen::Index e, const EvaluateOptions& options,
                   ReflectedLight& light) const {
    const bool gathers = settings_.reconstruction == Reconstruction::gather;
    const bool exact = gathers && settings_.first_reflection == FirstReflection::exact;
    std::vector<Field> fields = first_bounce(emitter, options, light.rays);
    if (options.watch.stop.stop_requested()) return false;
    Field first = Field::Zero(fields[0].rows(), fields[0].cols());
    for (const Field& field : fields) first += field / static_cast<float>(kReplicates);
    // The two buffers of §3.2.2: `last` is read, the next one is written, and they swap.
    Field later = Field::Zero(first.rows(), first.cols()), last = first;
    const int most = settings_.reflections == 0 ? kMaxReflections : settings_.reflections - 1 - (gathers ? 1 : 0);
    for (int i = 0; i < most; ++i) {
      if (options.watch.stop.stop_requested()) return false;
      last = bounced(last, options);
      later += last;
      if (last.norm() <= kNegligible * (first + later).norm()) break;
    }
    const auto n = static_cast<Eigen::Index>(receivers.size());
    Estimates fine = Estimates::Zero(n, 3 * kReplicates), coarse = fine;
    if (!exact) {
      std::vector<const Field*> read(kReplicates);
      if (!gathers)
        for (Field& field : fields) field += later;
      for (std::size_t k = 0; k < kReplicates; ++k) read[k] = &fields[k];
      add_read(read, fine);
      const Field blurred = coarsened(gathers ? first : Field(first + later));
      std::fill(read.begin(), read.end(), &blurred);
      add_read(read, coarse);
    }
    if (gathers && settings_.reflections != 1) {
      const Field all = first + later;
      add_gathered(all, fine);
      add_gathered(coarsened(all), coarse);
    }
    if (exact) {
      std::vector<Receiver> places;
      places.reserve(gathered_.size());
      for (const Gathered& one : gathered_) places.push_back({one.position_world_m, one.normal_world.normalized()});
      EvaluateOptions at_hits = options;
      at_hits.levels.clear();
      at_hits.watch.progress = {};
      const auto direct = direct_light(*rays, places, std::span(&emitter, 1), at_hits);
      if (!direct) return false;
      light.rays += direct->rays;
      for (std::size_t i = 0; i < gathered_.size(); ++i) {
        const Gathered& one = gathered_[i];
        Vec3 lux =
            direct->lux_per_level(static_cast<Eigen::Index>(i), 0) / gathered_per_replicate_ * one.reflectance_rgb;
        if (!grey_) lux = lux.cwiseProduct(emitter.colour_rgb);
        fine.row(one.receiver).template segment<3>(3 * one.replicate) += lux.transpose();
        coarse.row(one.receiver).template segment<3>(3 * one.replicate) += lux.transpose();
      }
    }
    const auto luminance = [&](const Estimates& of, Eigen::Index k) -> Eigen::VectorXd {
      return grey_ ? Eigen::VectorXd(of.col(3 * k)) : Eigen::VectorXd(of.middleCols<3>(3 * k) * kLuminanceOfRgb);
    };
    for (Eigen::Index k = 0; k < static_cast<Eigen::Index>(kReplicates); ++k) {
      light.replicates[static_cast<std::size_t>(k)].col(e) = luminance(fine, k);
      light.coarser.col(e) += luminance(coarse, k) / static_cast<double>(kReplicates);
      for (int c = 0; c < layout_.channels(); ++c)
        light.lux_per_level[static_cast<std::size_t>(c)].col(e) +=
            fine.col(3 * k + c) / static_cast<double>(kReplicates);
    }
    return true;
  }

  CacheSettings settings_;
  std::uint64_t seed_;
  bool grey_;
  FieldLayout layout_;
  DirectionCells cells_;
  std::vector<Material> materials_;
  std::vector<std::uint32_t> material_of_triangle_;
  std::vector<Read> above_;
  std::vector<Gathered> gathered_;
  std::uint32_t above_per_replicate_ = 1, gathered_per_replicate_ = 1;
  std::uint64_t cast_ = 0;
};

}  // namespace

BuiltMethod build_direction_cache(const Scene& scene, const RayScene& rays, std::span<const Receiver> receivers,
                                  const CacheSettings& settings, const RadianceCache::BuildOptions& options) {
  auto cache = std::make_unique<DirectionCache>(scene, rays, receivers, settings, options);
  if (!cache->build(scene, options))
    return tl::unexpected(Fault{Cause::cancelled, "", "stopped while building the radiance cache", {}});
  return cache;
}

}  // namespace luxrig
