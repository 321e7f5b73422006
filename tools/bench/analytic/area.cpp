/// Lambertian luminaires with size, against the closed forms of their form factors.

#include <cmath>

#include "tools/bench/analytic/case.h"
#include "tools/bench/analytic/closed_forms.h"

namespace luxrig {
namespace {

constexpr double kPanel_lm = 1000, kAreaTarget = 1e-4;

using Kind = LuminousShape::Kind;

/// Lies in z = 0 and shines down.
AnalyticCase flat_lamp(const std::string& name, Kind kind, const Vec3& size_m) {
  AnalyticCase one;
  one.name = name;
  one.direct_target = kAreaTarget;
  Emitter lamp{make_lambertian(kPanel_lm), {}};
  lamp.shape = {kind, size_m};
  one.emitters.push_back(lamp);
  return one;
}

/// E of an element for its form factor: a surface of area A and luminance Φ/(πA) gives Φ/A · F.
void expect(AnalyticCase& one, const Vec3& at_m, const Vec3& normal, double form_factor, double area_m2) {
  one.receivers.push_back({at_m, normal});
  one.exact_lx.push_back(kPanel_lm / area_m2 * form_factor);
}

void disks(const BenchOptions& options, std::vector<BenchRow>& rows) {
  const double r = 0.3, area_m2 = kPi * r * r;
  AnalyticCase parallel = flat_lamp("disk-parallel", Kind::disk, {2 * r, 0, 0});
  AnalyticCase perpendicular = flat_lamp("disk-perpendicular", Kind::disk, {2 * r, 0, 0});
  for (const double h : {0.001, 0.03, 0.1, 0.3, 1.0, 3.0, 30.0})
    for (const double a : {0.0, 0.05, 0.29, 0.31, 0.6, 2.0, 10.0}) {
      const double turn = 1.3 * a + h;
      const Vec3 out(std::cos(turn), std::sin(turn), 0), at_m = a * out - Vec3(0, 0, h);
      expect(parallel, at_m, Vec3::UnitZ(), form_factor_of_parallel_disk(r, h, a), area_m2);
      // The closed form looks across the axis: the element's horizon must not cut the disk.
      if (a > r) expect(perpendicular, at_m, -out, form_factor_of_perpendicular_disk(r, h, a), area_m2);
    }
  measure_case(parallel, options, rows);
  measure_case(perpendicular, options, rows);
}

void rectangles(const BenchOptions& options, std::vector<BenchRow>& rows) {
  const double x = 1.2, y = 0.3, area_m2 = x * y;
  AnalyticCase parallel = flat_lamp("rectangle-parallel", Kind::rectangle, {x, y, 0});
  AnalyticCase perpendicular = flat_lamp("rectangle-perpendicular", Kind::rectangle, {x, y, 0});
  for (const double h : {0.001, 0.02, 0.1, 0.5, 2.0, 20.0}) {
    for (const double u : {-0.5, -0.2, 0.0, 0.45})
      for (const double v : {-0.5, 0.1, 0.4}) {
        const double left = x * (0.5 + u), right = x * (0.5 - u), front = y * (0.5 + v), back = y * (0.5 - v);
        double sum = 0;
        for (const double a : {left, right})
          for (const double b : {front, back}) sum += form_factor_of_parallel_rectangle(a, b, h);
        expect(parallel, {x * u, y * v, -h}, Vec3::UnitZ(), sum, area_m2);
        // Beside the lamp, at right angles to it, facing +Y across the lamp, `gap` before its edge.
        for (const double gap : {0.0, 0.07, 1.0}) {
          double side = 0;
          for (const double a : {left, right})
            side += form_factor_of_perpendicular_rectangle(a, gap + y, h) -
                    form_factor_of_perpendicular_rectangle(a, gap, h);
          expect(perpendicular, {x * u, -y / 2 - gap, -h}, Vec3::UnitY(), side, area_m2);
        }
      }
  }
  measure_case(parallel, options, rows);
  measure_case(perpendicular, options, rows);
}

/// A sphere of uniform luminance shines like a point, Φ/4π cosθ/d², until the horizon cuts it.
void spheres(const BenchOptions& options, std::vector<BenchRow>& rows) {
  const double r = 0.2;
  AnalyticCase whole, cut;
  whole.name = "sphere-whole", cut.name = "sphere-cut";
  whole.direct_target = cut.direct_target = kAreaTarget;
  Emitter lamp{make_isotropic(kPanel_lm), {}};
  lamp.shape = {Kind::sphere, {2 * r, 0, 0}};
  whole.emitters = cut.emitters = {lamp};
  for (const double d : {0.2002, 0.21, 0.25, 0.4, 1.0, 4.0, 50.0})
    for (int k = 0; k <= 34; ++k) {
      const double theta = rad_from_deg(5 * k), factor = form_factor_of_sphere(r, d, theta);
      if (!(factor > 1e-9)) continue;
      const Vec3 away = Vec3(std::cos(0.3 * k), std::sin(0.3 * k), 0.2 * std::cos(k)).normalized();
      const Vec3 side = away.cross(Vec3::UnitZ()).normalized();
      const Vec3 normal = -away * std::cos(theta) + side * std::sin(theta);
      // π L = Φ / (4 π r²) for a sphere of uniform luminance
      expect(d / r * std::cos(theta) >= 1 ? whole : cut, d * away, normal, factor, 4 * kPi * r * r);
    }
  measure_case(whole, options, rows);
  measure_case(cut, options, rows);
}

}  // namespace

void add_area_rows(const BenchOptions& options, std::vector<BenchRow>& rows) {
  disks(options, rows);
  rectangles(options, rows);
  spheres(options, rows);
}

}  // namespace luxrig
