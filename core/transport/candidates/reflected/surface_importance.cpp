#include "core/transport/candidates/reflected/surface_importance.h"

#include <algorithm>
#include <cmath>

#include "core/transport/bsdf.h"
#include "core/transport/candidates/reflected/direction_guide.h"
#include "core/transport/sobol.h"

namespace luxrig {
namespace {

constexpr std::uint32_t kRaysPerReceiver = 128;
constexpr std::uint32_t kRaysPerPlace = 128;
/// Within this many cells, the kernel is averaged over a cell's square, not taken at its centre.
constexpr double kNearCells = 4;
constexpr int kNearGrid = 4;
/// Sweeps end when one changes W by less than this, relative, on average over all patches and receivers. Receivers
/// behind two doors, which light reaches last, count as much as bright ones.
constexpr double kConverged = 3e-4;
constexpr double kRoughlyConverged = 5e-2;  ///< enough to decide where rays are worthwhile
constexpr float kMin = 1e-30f;              ///< zero, for divisions
/// Columns solved together: few enough for the rows of all patches to stay in a core's own cache.
constexpr std::size_t kStrip = 2 * kRowUnit;
/// Neighbouring cells that share the results of their rays.
constexpr std::uint32_t kCellsPerGuide = 32;
constexpr std::uint32_t kMaxSweeps = 400;
constexpr double kCellsPerPatch = 1.5;

constexpr std::uint64_t kGridKey = 0x67726964, kReceiverKey = 0x72656376, kPlaceKey = 0x706c6163, kCellKey = 0x63656c6c,
                        kGuideKey = 0x67756964, kAgainKey = 0x61676169, kPatchKey = 0x70617463;

Vec3 grid_offset(std::uint64_t seed) {
  const SobolSequence random(mixed(seed, kGridKey));
  const auto u = random.set(0, 0);
  return {u[0], u[1], u[2]};
}

/// The node after a node's descendants; the number of nodes if there is none.
std::size_t next_after(const PointTree& tree, std::size_t node) {
  const std::uint32_t end = tree.nodes[node].end;
  while (node < tree.nodes.size() && tree.nodes[node].begin < end) ++node;
  return node;
}

Vec3 sphere_direction(double u, double v) {
  const double z = 1 - 2 * v, radius = std::sqrt(std::max(0.0, 1 - z * z)), angle = 2 * kPi * u;
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

}  // namespace

double diffuse_reflectance(const Material& material) {
  const double f0 = material.specular_reflectance;
  const double coat = f0 > 0 ? f0 + (1 - f0) / 21 : 0;
  return std::min(coat + (1 - coat) * material.luminous_reflectance(), 0.98);
}

SurfaceImportance::SurfaceImportance(const Scene& scene, const VisibilityScene& visibility,
                                     std::span<const Receiver> receivers, std::span<const Vec3> also_from_world_m,
                                     const ImportanceSettings& settings, const CandidateSkips& skips,
                                     const std::stop_token& stop)
    : scene_(*visibility.rays),
      receivers_(receivers),
      settings_(settings),
      stop_(stop),
      surfaces_(scene, *visibility.rays, settings.cell_m, grid_offset(settings.seed)),
      stride_((receivers.size() + kRowUnit - 1) / kRowUnit * kRowUnit) {
  discover(also_from_world_m);
  make_patches(scene);
  see_receivers(visibility, skips);
  if (settings_.guided_rays_per_cell > 0) solve(kRoughlyConverged);
  gather_bounces();
  solve(kConverged);
  rays_ += surfaces_.rays_cast();
  std::vector<Bounce>().swap(bounces_);
  add_terms();
  if (!settings_.keep_links) {
    from_rows_.clear();
    from_patches_.clear();
    std::vector<float>().swap(further_);
  }
}

/// Cells of a grid kCellsPerPatch times as coarse; each cell is part of one.
void SurfaceImportance::make_patches(const Scene& scene) {
  SurfaceCells coarse(scene, scene_, kCellsPerPatch * settings_.cell_m, grid_offset(mixed(settings_.seed, kPatchKey)));
  for (const auto& cell : surfaces_.cells())
    patch_of_cell_.push_back(coarse.cell_at(cell.places[0].position_world_m, cell.places[0].normal_world,
                                            settings_.max_cells, SurfaceCells::Found::from_surface));
  patches_ = static_cast<std::uint32_t>(coarse.cells().size());
  for (std::uint32_t& patch : patch_of_cell_)
    if (patch == SurfaceCells::kNone) patch = patches_++;  // in a cube with too many pieces: its own patch
  rays_ += coarse.rays_cast();
}

/// Finds cells that receivers, places and cells see, until there are no new ones.
void SurfaceImportance::discover(std::span<const Vec3> also_from_world_m) {
  const auto look = [&](const Vec3& from_m, const Vec3& direction, const Vec3& normal, SurfaceCells::Found by) {
    ++rays_;
    if (const auto hit = scene_.nearest(from_m, direction, normal))
      surfaces_.cell_at(hit->position_world_m, hit->normal_world, settings_.max_cells, by);
  };
  for (std::size_t r = 0; r < receivers_.size(); ++r) {
    const SobolSequence samples(mixed(mixed(settings_.seed, kReceiverKey), r));
    for (std::uint32_t i = 0; i < kRaysPerReceiver; ++i) {
      const auto [u, v] = samples.pair(i, 0, 0);
      look(receivers_[r].position_world_m, cosine_direction(receivers_[r].normal_world, u, v),
           receivers_[r].normal_world, SurfaceCells::Found::from_receiver);
    }
  }
  for (std::size_t p = 0; p < also_from_world_m.size() && !stop_.stop_requested(); ++p) {
    const SobolSequence samples(mixed(mixed(settings_.seed, kPlaceKey), p));
    for (std::uint32_t i = 0; i < kRaysPerPlace; ++i) {
      const auto [u, v] = samples.pair(i, 0, 0);
      look(also_from_world_m[p], sphere_direction(u, v), Vec3::Zero(), SurfaceCells::Found::from_lamp);
    }
  }
  for (std::uint32_t c = 0; c < surfaces_.cells().size() && !stop_.stop_requested(); ++c) trace_bounces(c);
  bounces_.resize(surfaces_.cells().size() * settings_.rays_per_cell, kNothing);
}

SurfaceImportance::Bounce SurfaceImportance::trace(const SurfaceCells::CellPoint& from, const Vec3& direction,
                                                   bool may_make_cells) {
  Bounce bounce{
      {static_cast<float>(direction.x()), static_cast<float>(direction.y()), static_cast<float>(direction.z())},
      kNoRow,
      0,
      0};
  ++rays_;
  const auto hit = scene_.nearest(from.position_world_m, direction, from.normal_world);
  if (!hit) return bounce;
  bounce.reflectance = static_cast<float>(diffuse_reflectance(scene_.material_of(hit->triangle)));
  if (!(bounce.reflectance > 0)) return bounce;
  const Vec3 &at_m = hit->position_world_m, &facing = hit->normal_world;
  const std::uint32_t cell =
      may_make_cells ? surfaces_.cell_at(at_m, facing, settings_.max_cells, SurfaceCells::Found::from_surface)
                     : surfaces_.find(at_m, facing, rays_);
  if (cell != SurfaceCells::kNone) bounce.row = nearest_row(cell, at_m);
  return bounce;
}

std::uint32_t SurfaceImportance::nearest_row(std::uint32_t cell, const Vec3& position_world_m) const {
  const auto& places = surfaces_.cells()[cell].places;
  std::uint32_t nearest = 0;
  double nearest_m2 = HUGE_VAL;
  for (std::uint32_t i = 0; i < kPlaces; ++i) {
    const double away_m2 = (places[i].position_world_m - position_world_m).squaredNorm();
    if (away_m2 < nearest_m2) nearest = i, nearest_m2 = away_m2;
  }
  return cell * kPlaces + nearest;
}

std::uint32_t SurfaceImportance::row_at(const Vec3& position_world_m, const Vec3& normal_world,
                                        std::uint64_t& rays) const {
  const std::uint32_t cell = surfaces_.find(position_world_m, normal_world, rays);
  if (cell == SurfaceCells::kNone) return kNoRow;
  const std::uint32_t row = nearest_row(cell, position_world_m);
  return live_[row] ? row : kNoRow;
}

void SurfaceImportance::trace_bounces(std::uint32_t cell) {
  const SobolSequence samples(mixed(mixed(settings_.seed, kCellKey), cell));
  for (std::uint32_t i = 0; i < settings_.rays_per_cell; ++i) {
    const auto [u, v] = samples.pair(i, 0, 0);
    // A copy of the cell's present place: the cell may get another place, and cells may move in memory.
    const SurfaceCells::CellPoint from = surfaces_.cells()[cell].places[i % kPlaces];
    Bounce bounce = trace(from, cosine_direction(from.normal_world, u, v), true);
    bounce.weight = bounce.reflectance / static_cast<float>(settings_.rays_per_cell);
    bounces_.push_back(bounce);
  }
}

/// Rays of the second round go where those of the first, from this cell and its neighbours, brought the largest shares
/// of a receiver's light through the cell. Every receiver counts equally, so that rays for those behind two doors go
/// through the doors. The first rays are not reused: a ray that makes its own direction likely would get a lower
/// weight, and reflected light would be too low (by 10 % in a flat of eight rooms).
void SurfaceImportance::gather_bounces() {
  const auto& cells = surfaces_.cells();
  const std::size_t first = settings_.rays_per_cell, guided = settings_.guided_rays_per_cell;
  std::vector<Vec3> middles_m;
  for (const auto& cell : cells) middles_m.push_back(cell.places[0].position_world_m);
  const PointTree tree(middles_m);
  std::vector<Bounce> fresh(cells.size() * (first + guided), kNothing);
  std::vector<float> per_share(stride_);
  std::vector<WeightedRow> met, met_patches;
  for (std::size_t n = 0; n < tree.nodes.size() && !stop_.stop_requested();) {
    const PointTree::Node& node = tree.nodes[n];
    if (node.right != 0 && node.end - node.begin > kCellsPerGuide) {
      ++n;
      continue;
    }
    n = next_after(tree, n);
    met.clear(), met_patches.clear();
    DirectionGuide guide;
    const auto each_bounce = [&](auto&& visit) {
      for (std::uint32_t i = node.begin; i < node.end; ++i)
        for (std::size_t q = 0; q < first; ++q)
          if (const Bounce& b = bounces_[tree.order[i] * first + q]; b.row != kNoRow) visit(b);
    };
    if (guided > 0)
      each_bounce([&](const Bounce& b) {
        met.push_back({b.row, b.reflectance});
        met_patches.push_back({patch_of_cell_[b.row / kPlaces], b.reflectance});
      });
    std::fill(per_share.begin(), per_share.end(), 0.0f);
    add_weighted_rows(first_.data(), met, per_share);
    add_weighted_rows(further_.data(), met_patches, per_share);
    for (float& sum : per_share) sum = sum > 0 ? 1 / sum : 0;
    if (guided > 0)
      each_bounce([&](const Bounce& b) {
        const float* a = first_.data() + b.row * stride_;
        const float* f = further_.data() + patch_of_cell_[b.row / kPlaces] * stride_;
        float worth = 0;
        for (std::size_t r = 0; r < stride_; ++r) worth += per_share[r] * (a[r] + f[r]);
        guide.add(Vec3(b.direction_world[0], b.direction_world[1], b.direction_world[2]), b.reflectance * worth);
      });
    guide.finish();
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      const std::uint32_t c = tree.order[i];
      const auto weighted = [&](const SurfaceCells::CellPoint& from, const Vec3& direction, double guide_density) {
        const double cosine_density = std::max(0.0, from.normal_world.dot(direction)) / kPi;
        if (!(cosine_density > 0)) return kNothing;
        Bounce bounce = trace(from, direction, false);
        bounce.weight = static_cast<float>(
            bounce.reflectance * cosine_density /
            (static_cast<double>(first) * cosine_density + static_cast<double>(guided) * guide_density));
        return bounce;
      };
      const SobolSequence again(mixed(mixed(settings_.seed, kAgainKey), c));
      const SobolSequence where_worth(mixed(mixed(settings_.seed, kGuideKey), c));
      Bounce* of_cell = fresh.data() + c * (first + guided);
      for (std::uint32_t q = 0; q < first; ++q) {
        const auto [u, v] = again.pair(q, 0, 0);
        const auto& from = cells[c].places[q % kPlaces];
        const Vec3 direction = cosine_direction(from.normal_world, u, v);
        of_cell[q] = weighted(from, direction, guide.density_per_sr(direction));
      }
      for (std::uint32_t q = 0; q < guided; ++q) {
        const auto [u, v] = where_worth.pair(q, 0, 0);
        const DirectionSample drawn = guide.sample(u, v);
        of_cell[first + q] = weighted(cells[c].places[q % kPlaces], drawn.direction, drawn.density_per_sr);
      }
    }
  }
  bounces_ = std::move(fresh);
}

/// cosθr cosθy / (π d²) at a place; nearby, its mean over a square of the size that the place represents.
double SurfaceImportance::kernel(const Receiver& receiver, const SurfaceCells::CellPoint& place) const {
  const auto at = [&](const Vec3& at_m) {
    const Vec3 towards_m = at_m - receiver.position_world_m;
    const double squared_m2 = towards_m.squaredNorm();
    const double cosines = receiver.normal_world.dot(towards_m) * -place.normal_world.dot(towards_m);
    return receiver.normal_world.dot(towards_m) > 0 && cosines > 0 ? cosines / (kPi * squared_m2 * squared_m2) : 0.0;
  };
  const double size_m = settings_.cell_m / std::sqrt(kPlaces);
  if ((place.position_world_m - receiver.position_world_m).squaredNorm() >= kNearCells * kNearCells * size_m * size_m)
    return at(place.position_world_m);
  const Vec3 u = place.normal_world.unitOrthogonal(), v = place.normal_world.cross(u);
  double sum = 0;
  for (int i = 0; i < kNearGrid; ++i)
    for (int j = 0; j < kNearGrid; ++j)
      sum +=
          at(place.position_world_m + size_m * (((i + 0.5) / kNearGrid - 0.5) * u + ((j + 0.5) / kNearGrid - 0.5) * v));
  return sum / (kNearGrid * kNearGrid);
}

std::vector<Vec3> SurfaceImportance::places_m() const {
  std::vector<Vec3> places_m;
  for (const auto& cell : surfaces_.cells())
    for (const auto& place : cell.places) places_m.push_back(place.position_world_m);
  return places_m;
}

void SurfaceImportance::see_receiver(const VisibilityScene& visibility, const PointTree& tree,
                                     std::span<const Vec3> places_m, std::size_t receiver,
                                     const CandidateSkips& skips) {
  VisiblePoints visible(visibility, receivers_[receiver], skips, 0, 0);
  double value = 0;
  visible.visit(
      tree, places_m,
      [&](std::uint32_t row) {
        const SurfaceCells::CellPoint& place = surfaces_.cells()[row / kPlaces].places[row % kPlaces];
        return (value = kernel(receivers_[receiver], place)) > 0;
      },
      [&](std::uint32_t row) { first_[row * stride_ + receiver] = static_cast<float>(value); });
  rays_ += visible.rays;
}

void SurfaceImportance::see_receivers(const VisibilityScene& visibility, const CandidateSkips& skips) {
  const std::vector<Vec3> places = places_m();
  first_.assign(rows_count() * stride_, 0.0f);
  const PointTree tree(places);
  for (std::size_t r = 0; r < receivers_.size() && !stop_.stop_requested(); ++r)
    see_receiver(visibility, tree, places, r, skips);
}

void SurfaceImportance::update_receiver(const VisibilityScene& visibility, std::size_t receiver,
                                        const CandidateSkips& skips) {
  rays_ = 0;
  const std::vector<Vec3> places = places_m();
  for (std::size_t row = 0; row < rows_count(); ++row) first_[row * stride_ + receiver] = 0;
  see_receiver(visibility, PointTree(places), places, receiver, skips);
  std::vector<float> gathered(patches_, 0.0f), value(patches_, 0.0f);
  for (std::uint32_t p = 0; p < patches_; ++p) {
    for (const WeightedRow& from : from_rows_[p]) gathered[p] += from.weight * first_[from.row * stride_ + receiver];
    value[p] = gathered[p];
  }
  for (std::uint32_t sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double change = 0, count = 0;
    for (std::uint32_t i = 0; i < patches_; ++i) {
      const std::size_t p = sweep % 2 == 0 ? i : patches_ - 1 - i;
      float fresh = gathered[p];
      for (const WeightedRow& from : from_patches_[p]) fresh += from.weight * value[from.row];
      change += std::abs(fresh - value[p]) / std::max(fresh, kMin);
      count += fresh > 0;
      value[p] = fresh;
    }
    if (change <= kConverged * count) break;
  }
  for (std::uint32_t p = 0; p < patches_; ++p) further_[p * stride_ + receiver] = value[p];
  add_terms();
}

/// Hits of the rays of each patch's cells: rows for the first term, patches for the second.
void SurfaceImportance::link_patches() {
  const std::size_t cells = surfaces_.cells().size(), per_cell = cells == 0 ? 0 : bounces_.size() / cells;
  std::vector<std::vector<std::uint32_t>> cells_of_patch(patches_);
  for (std::uint32_t c = 0; c < cells; ++c) cells_of_patch[patch_of_cell_[c]].push_back(c);
  from_rows_.assign(patches_, {});
  from_patches_.assign(patches_, {});
  const auto hits_of = [&](std::uint32_t cell) {
    return static_cast<float>(surfaces_.cells()[cell].hits_from_surfaces + 1);
  };
  // Index of a row in the current list; stale if the list does not have the row there.
  std::vector<std::uint32_t> place(std::max<std::size_t>(rows_count(), patches_), 0);
  std::vector<WeightedRow> gathered;
  const auto add = [&](std::uint32_t row, float weight) {
    std::uint32_t& at = place[row];
    if (at < gathered.size() && gathered[at].row == row) {
      gathered[at].weight += weight;
    } else {
      at = static_cast<std::uint32_t>(gathered.size());
      gathered.push_back({row, weight});
    }
  };
  for (std::uint32_t p = 0; p < patches_; ++p) {
    // A sliver of a cell at the edge of a wall counts by its number of hits, which is proportional to its area.
    float hits = 0;
    for (const std::uint32_t c : cells_of_patch[p]) hits += hits_of(c);
    const auto gather = [&](std::vector<WeightedRow>& list, const auto& row_of) {
      gathered.clear();
      for (const std::uint32_t c : cells_of_patch[p])
        for (std::size_t q = 0; q < per_cell; ++q)
          if (const Bounce& b = bounces_[c * per_cell + q]; b.row != kNoRow && b.weight > 0)
            add(row_of(b.row), hits_of(c) / hits * b.weight);
      list = gathered;
    };
    gather(from_rows_[p], [](std::uint32_t row) { return row; });
    gather(from_patches_[p], [&](std::uint32_t row) { return patch_of_cell_[row / kPlaces]; });
  }
}

/// The second term: each patch gathers the first term by its cells' rays, and then the second by Gauss–Seidel
/// iteration, forwards and backwards in turn. Receivers are independent.
void SurfaceImportance::solve(double converged) {
  link_patches();
  further_.resize(patches_ * stride_, 0.0f);
  for (std::size_t from = 0; from < stride_ && !stop_.stop_requested(); from += kStrip)
    solve_strip(from, std::min(kStrip, stride_ - from), converged);
}

void SurfaceImportance::solve_strip(std::size_t from, std::size_t width, double converged) {
  const auto packed = [&](const std::vector<float>& rows) {
    std::vector<float> strip(rows.size() / stride_ * width);
    for (std::size_t row = 0; row * width < strip.size(); ++row)
      std::copy_n(rows.data() + row * stride_ + from, width, strip.data() + row * width);
    return strip;
  };
  std::vector<float> gathered(patches_ * width, 0.0f), value = packed(further_);
  {
    const std::vector<float> first = packed(first_);
    for (std::uint32_t p = 0; p < patches_; ++p)
      add_weighted_rows(first.data(), from_rows_[p], std::span(gathered).subspan(p * width, width));
  }
  std::array<float, kStrip> fresh{};
  for (std::uint32_t sweep = 0; sweep < kMaxSweeps && !stop_.stop_requested(); ++sweep) {
    double change = 0, count = 0;
    for (std::uint32_t i = 0; i < patches_; ++i) {
      const std::size_t p = sweep % 2 == 0 ? i : patches_ - 1 - i;
      std::copy_n(gathered.data() + p * width, width, fresh.data());
      add_weighted_rows(value.data(), from_patches_[p], std::span(fresh).first(width));
      float* to = value.data() + p * width;
      float patch_change[4] = {}, patch_count[4] = {};
      for (std::size_t r = 0; r < width; r += 4)
        for (std::size_t k = 0; k < 4; ++k) {
          patch_change[k] += std::abs(fresh[r + k] - to[r + k]) / std::max(fresh[r + k], kMin);
          patch_count[k] += fresh[r + k] > 0 ? 1.0f : 0.0f;
          to[r + k] = fresh[r + k];
        }
      for (std::size_t k = 0; k < 4; ++k) change += patch_change[k], count += patch_count[k];
    }
    if (change <= converged * count) break;
  }
  for (std::size_t p = 0; p < patches_; ++p)
    std::copy_n(value.data() + p * width, width, further_.data() + p * stride_ + from);
}

void SurfaceImportance::add_terms() {
  std::vector<float>& sum = settings_.keep_links ? both_ = first_ : first_;
  live_.resize(rows_count());
  for (std::size_t i = 0; i < live_.size(); ++i) {
    float* row = sum.data() + i * stride_;
    const float* further = further_.data() + patch_of_cell_[i / kPlaces] * stride_;
    for (std::size_t r = 0; r < stride_; ++r) row[r] += further[r];
    live_[i] = std::any_of(row, row + stride_, [](float w) { return w > 0; });
  }
}

std::size_t SurfaceImportance::bytes() const {
  std::size_t links = 0;
  for (std::size_t p = 0; p < from_rows_.size(); ++p) links += from_rows_[p].size() + from_patches_[p].size();
  return (first_.size() + further_.size() + both_.size()) * sizeof(float) + bounces_.size() * sizeof(Bounce) +
         links * sizeof(WeightedRow) + surfaces_.cells().size() * 2 * sizeof(SurfaceCells::Cell);
}

}  // namespace luxrig
