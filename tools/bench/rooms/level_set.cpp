#include "tools/bench/rooms/level_set.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace luxrig {
namespace {

constexpr std::uint32_t kNoNetVertex = 0xffffffff;
/// No crossing is nearer to a grid corner than about this share of a cell. Otherwise vertices of neighbouring cells
/// could coincide.
constexpr double kOffCorner = 0.02;

class SurfaceNet {
 public:
  SurfaceNet(const Eigen::AlignedBox3d& box_m, double cell_m, const std::function<double(const Vec3&)>& distance_m)
      : low_m_(box_m.min()), cell_m_(cell_m) {
    for (int k = 0; k < 3; ++k) corners_[k] = std::max(3, static_cast<int>(std::ceil(box_m.sizes()[k] / cell_m)) + 1);
    value_.reserve(static_cast<std::size_t>(corners_.x()) * corners_.y() * corners_.z());
    for (int z = 0; z < corners_.z(); ++z)
      for (int y = 0; y < corners_.y(); ++y)
        for (int x = 0; x < corners_.x(); ++x) {
          const Eigen::Vector3i c(x, y, z);
          const bool border = (c.array() == 0 || c.array() == corners_.array() - 1).any();
          const double d = border ? cell_m : distance_m(low_m_ + cell_m * c.cast<double>());
          value_.push_back(d < 0 ? std::min(d, -kOffCorner * cell_m) : std::max(d, kOffCorner * cell_m));
        }
  }

  ClosedMesh mesh() {
    vertex_of_cell_.assign(value_.size(), kNoNetVertex);
    each({0, 0, 0}, corners_ - Eigen::Vector3i::Ones(), [&](const Eigen::Vector3i& cell) { place(cell); });
    for (int axis = 0; axis < 3; ++axis) {
      // The outermost corners are all outside, so no edge along the box's faces crosses the surface.
      Eigen::Vector3i low(1, 1, 1);
      low[axis] = 0;
      each(low, corners_ - Eigen::Vector3i::Ones(), [&](const Eigen::Vector3i& corner) { span(corner, axis); });
    }
    return std::move(mesh_);
  }

 private:
  template <class Visit>
  static void each(const Eigen::Vector3i& low, const Eigen::Vector3i& high, Visit&& visit) {
    for (int z = low.z(); z < high.z(); ++z)
      for (int y = low.y(); y < high.y(); ++y)
        for (int x = low.x(); x < high.x(); ++x) visit(Eigen::Vector3i(x, y, z));
  }
  [[nodiscard]] std::size_t index(const Eigen::Vector3i& c) const {
    return (static_cast<std::size_t>(c.z()) * corners_.y() + c.y()) * corners_.x() + c.x();
  }
  [[nodiscard]] double value(const Eigen::Vector3i& c) const { return value_[index(c)]; }

  /// A vertex in the middle of the points where the surface crosses the cell's edges.
  void place(const Eigen::Vector3i& cell) {
    Vec3 sum = Vec3::Zero();
    int crossings = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 4; ++side) {
        Eigen::Vector3i a = cell;
        a[(axis + 1) % 3] += side & 1, a[(axis + 2) % 3] += side >> 1;
        const double from = value(a), to = value(a + Eigen::Vector3i::Unit(axis));
        if ((from < 0) == (to < 0)) continue;
        sum += a.cast<double>() + from / (from - to) * Vec3::Unit(axis);
        ++crossings;
      }
    if (crossings == 0) return;
    vertex_of_cell_[index(cell)] = static_cast<std::uint32_t>(mesh_.vertices_m.size());
    mesh_.vertices_m.push_back(low_m_ + cell_m_ / crossings * sum);
  }

  /// Two triangles over the four cells around a grid edge that crosses the surface.
  void span(const Eigen::Vector3i& corner, int axis) {
    const bool inside = value(corner) < 0;
    if (inside == (value(corner + Eigen::Vector3i::Unit(axis)) < 0)) return;
    const Eigen::Vector3i b = Eigen::Vector3i::Unit((axis + 1) % 3), c = Eigen::Vector3i::Unit((axis + 2) % 3);
    std::array<std::uint32_t, 4> quad = {vertex_of_cell_[index(corner - b - c)], vertex_of_cell_[index(corner - c)],
                                         vertex_of_cell_[index(corner)], vertex_of_cell_[index(corner - b)]};
    if (!inside) std::swap(quad[1], quad[3]);
    const auto& v = mesh_.vertices_m;
    const std::size_t first = (v[quad[0]] - v[quad[2]]).norm() <= (v[quad[1]] - v[quad[3]]).norm() ? 0 : 1;
    mesh_.triangles.push_back({quad[first], quad[first + 1], quad[first + 2]});
    mesh_.triangles.push_back({quad[first], quad[first + 2], quad[(first + 3) % 4]});
  }

  Vec3 low_m_;
  double cell_m_;
  Eigen::Vector3i corners_;
  std::vector<double> value_;
  std::vector<std::uint32_t> vertex_of_cell_;
  ClosedMesh mesh_;
};

}  // namespace

ClosedMesh mesh_level_set(const Eigen::AlignedBox3d& box_m, double cell_m,
                          const std::function<double(const Vec3&)>& distance_m) {
  LUXRIG_CHECK(!box_m.isEmpty() && cell_m > 0, "cell {} m", cell_m);
  return SurfaceNet(box_m, cell_m, distance_m).mesh();
}

double distance_to_segment_m(const Vec3& point_m, const Vec3& a_m, const Vec3& b_m) {
  const Vec3 along = b_m - a_m;
  const double length_squared = along.squaredNorm();
  const double t = length_squared > 0 ? std::clamp((point_m - a_m).dot(along) / length_squared, 0.0, 1.0) : 0.0;
  return (point_m - a_m - t * along).norm();
}

double blended_least_m(double a_m, double b_m, double blend_m) {
  const double h = std::max(0.0, blend_m - std::abs(a_m - b_m));
  return std::min(a_m, b_m) - h * h / (4 * blend_m);
}

}  // namespace luxrig
