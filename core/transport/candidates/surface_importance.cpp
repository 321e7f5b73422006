#include "core/transport/candidates/surface_importance.h"

#include <algorithm>
#include <cmath>

#include "core/transport/bsdf.h"
#include "core/transport/candidates/direction_guide.h"
#include "core/transport/sobol.h"

namespace luxrig {
namespace {

constexpr std::uint32_t kRaysPerReceiver = 128;
constexpr std::uint32_t kRaysPerPlace = 32;
/// Nearer than this many cells, the kernel is averaged over a cell's square instead of taken at its middle.
constexpr double kNearCells = 4;
constexpr int kNearGrid = 4;
/// Sweeps end when one changes the sum of W by less than this.
constexpr double kConverged = 1e-4;
constexpr double kRoughlyConverged = 2e-2;  ///< to say where rays are worth while
/// Columns that are solved together: few enough for the rows of all patches to stay in a core's own cache.
constexpr std::size_t kStrip = 2 * kRowUnit;
/// Neighbouring cells that share what their rays found.
constexpr std::uint32_t kCellsPerGuide = 32;
constexpr std::uint32_t kMostSweeps = 400;
constexpr double kCellsPerPatch = 1.5;

constexpr std::uint64_t kGridKey = 0x67726964, kReceiverKey = 0x72656376, kPlaceKey = 0x706c6163, kCellKey = 0x63656c6c,
                        kGuidedKey = 0x67756964, kAgainKey = 0x61676169, kPatchKey = 0x70617463;

Vec3 grid_offset(std::uint64_t seed) {
  const SobolSequence random(mixed(seed, kGridKey));
  const auto u = random.set(0, 0);
  return {u[0], u[1], u[2]};
}

/// The node after a node's descendants; the number of nodes after the last.
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
    from_cells_.clear();
    from_patches_.clear();
    std::vector<float>().swap(further_);
  }
}

/// Cells of a grid kCellsPerPatch times as coarse, of which the cells are parts.
void SurfaceImportance::make_patches(const Scene& scene) {
  SurfaceCells coarse(scene, scene_, kCellsPerPatch * settings_.cell_m, grid_offset(mixed(settings_.seed, kPatchKey)));
  for (const auto& cell : surfaces_.cells())
    patch_of_cell_.push_back(coarse.cell_at(cell.position_world_m, cell.normal_world, settings_.most_cells));
  patches_ = static_cast<std::uint32_t>(coarse.cells().size());
  for (std::uint32_t& patch : patch_of_cell_)
    if (patch == SurfaceCells::kNone) patch = patches_++;  // in a cube with too many pieces: a patch of its own
  rays_ += coarse.rays_cast();
}

/// Cells that receivers see, places see, and cells see, until there are no more.
void SurfaceImportance::discover(std::span<const Vec3> also_from_world_m) {
  const auto look = [&](const Vec3& from_m, const Vec3& direction, const Vec3& normal) {
    ++rays_;
    if (const auto hit = scene_.nearest(from_m, direction, normal))
      surfaces_.cell_at(hit->position_world_m, hit->normal_world, settings_.most_cells);
  };
  for (std::size_t r = 0; r < receivers_.size(); ++r) {
    const SobolSequence samples(mixed(mixed(settings_.seed, kReceiverKey), r));
    for (std::uint32_t i = 0; i < kRaysPerReceiver; ++i) {
      const auto [u, v] = samples.pair(i, 0, 0);
      look(receivers_[r].position_world_m, cosine_direction(receivers_[r].normal_world, u, v),
           receivers_[r].normal_world);
    }
  }
  for (std::size_t p = 0; p < also_from_world_m.size() && !stop_.stop_requested(); ++p) {
    const SobolSequence samples(mixed(mixed(settings_.seed, kPlaceKey), p));
    for (std::uint32_t i = 0; i < kRaysPerPlace; ++i) {
      const auto [u, v] = samples.pair(i, 0, 0);
      look(also_from_world_m[p], sphere_direction(u, v), Vec3::Zero());
    }
  }
  for (std::uint32_t c = 0; c < surfaces_.cells().size() && !stop_.stop_requested(); ++c) trace_bounces(c);
  bounces_.resize(surfaces_.cells().size() * settings_.rays_per_cell, kNothing);
}

SurfaceImportance::Bounce SurfaceImportance::trace(std::uint32_t cell, const Vec3& direction, bool may_make_cells) {
  const Vec3 from_m = surfaces_.cells()[cell].position_world_m, normal = surfaces_.cells()[cell].normal_world;
  Bounce bounce{
      {static_cast<float>(direction.x()), static_cast<float>(direction.y()), static_cast<float>(direction.z())},
      SurfaceCells::kNone,
      0,
      0};
  ++rays_;
  const auto hit = scene_.nearest(from_m, direction, normal);
  if (!hit) return bounce;
  bounce.reflectance = static_cast<float>(diffuse_reflectance(scene_.material_of(hit->triangle)));
  if (bounce.reflectance > 0)
    bounce.cell = may_make_cells ? surfaces_.cell_at(hit->position_world_m, hit->normal_world, settings_.most_cells)
                                 : surfaces_.find(hit->position_world_m, hit->normal_world, rays_);
  return bounce;
}

void SurfaceImportance::trace_bounces(std::uint32_t cell) {
  const Vec3 normal = surfaces_.cells()[cell].normal_world;
  const SobolSequence samples(mixed(mixed(settings_.seed, kCellKey), cell));
  for (std::uint32_t i = 0; i < settings_.rays_per_cell; ++i) {
    const auto [u, v] = samples.pair(i, 0, 0);
    // From where the cell stands now: another place may come to stand for it.
    Bounce bounce = trace(cell, cosine_direction(normal, u, v), true);
    bounce.weight = bounce.reflectance / static_cast<float>(settings_.rays_per_cell);
    bounces_.push_back(bounce);
  }
}

/// Rays of the second round, drawn where those of the first, from this cell and its neighbours, brought the largest
/// shares of what a receiver gets by way of the cell; every receiver counts alike, so that those behind two doors have
/// their rays through the doors. The first rays themselves are not used again: a ray that makes its own direction
/// likely would be weighted down for it, and reflected light come out too low (by 10 % in a flat of eight rooms).
void SurfaceImportance::gather_bounces() {
  const auto& cells = surfaces_.cells();
  const std::size_t first = settings_.rays_per_cell, guided = settings_.guided_rays_per_cell;
  const PointTree tree(places_m());
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
          if (const Bounce& b = bounces_[tree.order[i] * first + q]; b.cell != SurfaceCells::kNone) visit(b);
    };
    if (guided > 0)
      each_bounce([&](const Bounce& b) {
        met.push_back({b.cell, b.reflectance});
        met_patches.push_back({patch_of_cell_[b.cell], b.reflectance});
      });
    std::fill(per_share.begin(), per_share.end(), 0.0f);
    add_weighted_rows(first_.data(), met, per_share);
    add_weighted_rows(further_.data(), met_patches, per_share);
    for (float& sum : per_share) sum = sum > 0 ? 1 / sum : 0;
    if (guided > 0)
      each_bounce([&](const Bounce& b) {
        const float *a = first_.data() + b.cell * stride_, *f = further_.data() + patch_of_cell_[b.cell] * stride_;
        float worth = 0;
        for (std::size_t r = 0; r < stride_; ++r) worth += per_share[r] * (a[r] + f[r]);
        guide.add(Vec3(b.direction_world[0], b.direction_world[1], b.direction_world[2]), b.reflectance * worth);
      });
    guide.finish();
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      const std::uint32_t c = tree.order[i];
      const Vec3& normal = cells[c].normal_world;
      const auto weighted = [&](const Vec3& direction, double guide_density) {
        const double cosine_density = std::max(0.0, normal.dot(direction)) / kPi;
        if (!(cosine_density > 0)) return kNothing;
        Bounce bounce = trace(c, direction, false);
        bounce.weight = static_cast<float>(
            bounce.reflectance * cosine_density /
            (static_cast<double>(first) * cosine_density + static_cast<double>(guided) * guide_density));
        return bounce;
      };
      const SobolSequence again(mixed(mixed(settings_.seed, kAgainKey), c));
      const SobolSequence where_worth(mixed(mixed(settings_.seed, kGuidedKey), c));
      Bounce* of_cell = fresh.data() + c * (first + guided);
      for (std::uint32_t q = 0; q < first; ++q) {
        const auto [u, v] = again.pair(q, 0, 0);
        const Vec3 direction = cosine_direction(normal, u, v);
        of_cell[q] = weighted(direction, guide.density_per_sr(direction));
      }
      for (std::uint32_t q = 0; q < guided; ++q) {
        const auto [u, v] = where_worth.pair(q, 0, 0);
        const DirectionSample drawn = guide.sample(u, v);
        of_cell[first + q] = weighted(drawn.direction, drawn.density_per_sr);
      }
    }
  }
  bounces_ = std::move(fresh);
}

/// cosθr cosθy / (π d²), at the cell's place; near by, its mean over a square of the cell's size there.
double SurfaceImportance::kernel(const Receiver& receiver, const SurfaceCells::Cell& cell) const {
  const auto at = [&](const Vec3& place_m) {
    const Vec3 towards_m = place_m - receiver.position_world_m;
    const double squared_m2 = towards_m.squaredNorm();
    const double cosines = receiver.normal_world.dot(towards_m) * -cell.normal_world.dot(towards_m);
    return receiver.normal_world.dot(towards_m) > 0 && cosines > 0 ? cosines / (kPi * squared_m2 * squared_m2) : 0.0;
  };
  const double size_m = settings_.cell_m;
  if ((cell.position_world_m - receiver.position_world_m).squaredNorm() >= kNearCells * kNearCells * size_m * size_m)
    return at(cell.position_world_m);
  const Vec3 u = cell.normal_world.unitOrthogonal(), v = cell.normal_world.cross(u);
  double sum = 0;
  for (int i = 0; i < kNearGrid; ++i)
    for (int j = 0; j < kNearGrid; ++j)
      sum +=
          at(cell.position_world_m + size_m * (((i + 0.5) / kNearGrid - 0.5) * u + ((j + 0.5) / kNearGrid - 0.5) * v));
  return sum / (kNearGrid * kNearGrid);
}

std::vector<Vec3> SurfaceImportance::places_m() const {
  std::vector<Vec3> places_m;
  for (const auto& cell : surfaces_.cells()) places_m.push_back(cell.position_world_m);
  return places_m;
}

void SurfaceImportance::see_receiver(const VisibilityScene& visibility, const PointTree& tree,
                                     std::span<const Vec3> places_m, std::size_t receiver,
                                     const CandidateSkips& skips) {
  VisiblePoints visible(visibility, receivers_[receiver], skips, 0, 0);
  double value = 0;
  visible.visit(
      tree, places_m, [&](std::uint32_t c) { return (value = kernel(receivers_[receiver], surfaces_.cells()[c])) > 0; },
      [&](std::uint32_t c) { first_[c * stride_ + receiver] = static_cast<float>(value); });
  rays_ += visible.rays;
}

void SurfaceImportance::see_receivers(const VisibilityScene& visibility, const CandidateSkips& skips) {
  const std::vector<Vec3> places = places_m();
  first_.assign(places.size() * stride_, 0.0f);
  const PointTree tree(places);
  for (std::size_t r = 0; r < receivers_.size() && !stop_.stop_requested(); ++r)
    see_receiver(visibility, tree, places, r, skips);
}

void SurfaceImportance::update_receiver(const VisibilityScene& visibility, std::size_t receiver,
                                        const CandidateSkips& skips) {
  rays_ = 0;
  const std::vector<Vec3> places = places_m();
  const std::size_t cells = places.size();
  for (std::size_t c = 0; c < cells; ++c) first_[c * stride_ + receiver] = 0;
  see_receiver(visibility, PointTree(places), places, receiver, skips);
  std::vector<float> gathered(patches_, 0.0f), value(patches_, 0.0f);
  for (std::uint32_t p = 0; p < patches_; ++p) {
    for (const WeightedRow& from : from_cells_[p]) gathered[p] += from.weight * first_[from.row * stride_ + receiver];
    value[p] = gathered[p];
  }
  for (std::uint32_t sweep = 0; sweep < kMostSweeps; ++sweep) {
    double change = 0, sum = 0;
    for (std::uint32_t i = 0; i < patches_; ++i) {
      const std::size_t p = sweep % 2 == 0 ? i : patches_ - 1 - i;
      float fresh = gathered[p];
      for (const WeightedRow& from : from_patches_[p]) fresh += from.weight * value[from.row];
      change += std::abs(fresh - value[p]);
      sum += fresh;
      value[p] = fresh;
    }
    if (change <= kConverged * sum) break;
  }
  for (std::uint32_t p = 0; p < patches_; ++p) further_[p * stride_ + receiver] = value[p];
  add_terms();
}

/// What the rays of each patch's cells meet: cells, for the first term; patches, for the second.
void SurfaceImportance::link_patches() {
  const std::size_t cells = surfaces_.cells().size(), per_cell = cells == 0 ? 0 : bounces_.size() / cells;
  std::vector<std::vector<std::uint32_t>> cells_of_patch(patches_);
  for (std::uint32_t c = 0; c < cells; ++c) cells_of_patch[patch_of_cell_[c]].push_back(c);
  from_cells_.assign(patches_, {});
  from_patches_.assign(patches_, {});
  const auto merge = [](std::vector<WeightedRow>& list) {
    std::stable_sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.row < b.row; });
    std::size_t kept = 0;
    for (const WeightedRow entry : list)
      if (kept > 0 && list[kept - 1].row == entry.row)
        list[kept - 1].weight += entry.weight;
      else
        list[kept++] = entry;
    list.resize(kept);
    list.shrink_to_fit();
  };
  for (std::uint32_t p = 0; p < patches_; ++p) {
    const auto share = 1 / static_cast<float>(cells_of_patch[p].size());
    for (const std::uint32_t c : cells_of_patch[p])
      for (std::size_t q = 0; q < per_cell; ++q)
        if (const Bounce& b = bounces_[c * per_cell + q]; b.cell != SurfaceCells::kNone && b.weight > 0) {
          from_cells_[p].push_back({b.cell, share * b.weight});
          from_patches_[p].push_back({patch_of_cell_[b.cell], share * b.weight});
        }
    merge(from_cells_[p]);
    merge(from_patches_[p]);
  }
}

/// The second term: what a patch gathers of the first term by its cells' rays, and then of itself, by Gauss and
/// Seidel's iteration, there and back in turn. Receivers are independent of each other.
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
      add_weighted_rows(first.data(), from_cells_[p], std::span(gathered).subspan(p * width, width));
  }
  std::array<float, kStrip> fresh{};
  for (std::uint32_t sweep = 0; sweep < kMostSweeps && !stop_.stop_requested(); ++sweep, ++sweeps_) {
    double change = 0, sum = 0;
    for (std::uint32_t i = 0; i < patches_; ++i) {
      const std::size_t p = sweep % 2 == 0 ? i : patches_ - 1 - i;
      std::copy_n(gathered.data() + p * width, width, fresh.data());
      add_weighted_rows(value.data(), from_patches_[p], std::span(fresh).first(width));
      float* to = value.data() + p * width;
      float patch_change[4] = {}, patch_sum[4] = {};
      for (std::size_t r = 0; r < width; r += 4)
        for (std::size_t k = 0; k < 4; ++k) {
          patch_change[k] += std::abs(fresh[r + k] - to[r + k]);
          patch_sum[k] += fresh[r + k];
          to[r + k] = fresh[r + k];
        }
      for (std::size_t k = 0; k < 4; ++k) change += patch_change[k], sum += patch_sum[k];
    }
    if (change <= converged * sum) break;
  }
  for (std::size_t p = 0; p < patches_; ++p)
    std::copy_n(value.data() + p * width, width, further_.data() + p * stride_ + from);
}

void SurfaceImportance::add_terms() {
  std::vector<float>& sum = settings_.keep_links ? both_ = first_ : first_;
  live_.resize(surfaces_.cells().size());
  for (std::size_t c = 0; c < live_.size(); ++c) {
    float* row = sum.data() + c * stride_;
    const float* further = further_.data() + patch_of_cell_[c] * stride_;
    for (std::size_t r = 0; r < stride_; ++r) row[r] += further[r];
    live_[c] = std::any_of(row, row + stride_, [](float w) { return w > 0; });
  }
}

std::size_t SurfaceImportance::bytes() const {
  std::size_t links = 0;
  for (std::size_t p = 0; p < from_cells_.size(); ++p) links += from_cells_[p].size() + from_patches_[p].size();
  return (first_.size() + further_.size() + both_.size()) * sizeof(float) + bounces_.size() * sizeof(Bounce) +
         links * sizeof(WeightedRow) + surfaces_.cells().size() * 2 * sizeof(SurfaceCells::Cell);
}

}  // namespace luxrig
