/// Luminaires without size: the distance law, analytic distributions, and table look-up.

#include <fmt/format.h>

#include <cmath>
#include <random>

#include "core/photometry/files/ies.h"
#include "tools/bench/analytic/case.h"
#include "tools/bench/analytic/closed_forms.h"

namespace luxrig {
namespace {

constexpr double kPoint_lm = 1000, kPointTarget = 1e-6;

/// E = Φ/4π cosθ/d² in open air, for 1 000 random pairs from millimetres to kilometres apart: the largest relative
/// error.
void add_pairs(const BenchOptions& options, std::vector<BenchRow>& rows) {
  const RayScene open_air{Scene{}};
  for (const Method& method : methods()) {
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> unit(-1, 1), exponent(-3, 3);
    const auto any = [&] { return Vec3(unit(random), unit(random), unit(random)); };
    Measured all;
    double worst = 0, seconds = 0;
    for (int i = 0; i < 1000 && all.refused.empty(); ++i) {
      const double size_m = std::pow(10, exponent(random));
      const Vec3 to_m = size_m * any();
      Vec3 normal = any().normalized();
      if (normal.dot(to_m) < 0) normal = -normal;
      EvaluateOptions evaluate;
      evaluate.threads = options.threads;
      const std::vector<Receiver> receiver = {{Vec3::Zero(), normal}};
      const std::vector<Emitter> bulb = {{make_isotropic(kPoint_lm), {Mat3::Identity(), to_m}}};
      all = measure(method, open_air, receiver, bulb, evaluate);
      seconds += all.seconds;
      if (!all.refused.empty()) break;
      long double d2 = 0, height = 0;
      for (int k = 0; k < 3; ++k) {
        d2 += static_cast<long double>(to_m[k]) * to_m[k];
        height += static_cast<long double>(normal[k]) * to_m[k];
      }
      const long double exact_lx = kPoint_lm / (4 * std::numbers::pi_v<long double>)*height / (d2 * std::sqrt(d2));
      worst = std::max(worst, static_cast<double>(std::abs(all.matrix.lux_per_level(0, 0) / exact_lx - 1)));
    }
    all.seconds = seconds;
    rows.push_back(row_of("point-source", method.name, worst, all, std::nullopt, kPointTarget));
  }
}

/// A lamp at 2.5 m that is rotated by `turn` and shines down, over a floor of 21 × 21 places.
AnalyticCase over_a_floor(const std::string& name, const Intensity& intensity, const Mat3& turn,
                          double (*candela)(double gamma_rad, double c_rad)) {
  AnalyticCase one;
  one.name = name;
  one.direct_target = kPointTarget;
  const Vec3 lamp_m(0.1, -0.2, 2.5);
  one.emitters.push_back({intensity, {turn, lamp_m}});
  for (int i = -10; i <= 10; ++i)
    for (int j = -10; j <= 10; ++j) {
      const Vec3 at_m(0.4 * i, 0.4 * j, 0), away_m = at_m - lamp_m, leaving = turn.transpose() * away_m.normalized();
      one.receivers.push_back({at_m, Vec3::UnitZ()});
      const double gamma = std::atan2(std::hypot(leaving.x(), leaving.y()), -leaving.z());
      const double c = std::atan2(leaving.y(), leaving.x());
      one.exact_lx.push_back(candela(gamma, c < 0 ? c + 2 * kPi : c) * lamp_m.z() / std::pow(away_m.norm(), 3));
    }
  return one;
}

template <int kExponent>
double cosine_power(double gamma_rad, double) {
  return gamma_rad < kPi / 2 ? kPoint_lm * (kExponent + 1) / (2 * kPi) * std::pow(std::cos(gamma_rad), kExponent) : 0;
}

/// The formula in make_spot's header for a beam of 30° and a field of 54°. Its flux is by Gauss' rule over its two
/// smooth pieces.
double spot_candela(double gamma_rad, double) {
  const double b = rad_from_deg(15), f = rad_from_deg(27), p = std::log(std::log2(10)) / std::log(f / b);
  const auto shape = [&](double g) {
    if (g >= 2 * f) return 0.0;
    const double t = std::max(0.0, g / f - 1), smooth = 1 - t * t * t * (10 - 15 * t + 6 * t * t);
    return std::exp2(-std::pow(g / b, p)) * smooth;
  };
  static const double flux = [&] {
    const GaussNodes rule = gauss_rule(60);
    double sum = 0;
    for (const double from : {0.0, f})
      sum += integral(rule, from, from + f, 0, 1, [&](double g, double) { return 2 * kPi * shape(g) * std::sin(g); });
    return sum;
  }();
  return kPoint_lm / flux * shape(gamma_rad);
}

constexpr int kPlanes = 13, kAngles = 19;  ///< every 30° around the axis, every 5° from the nadir to the horizon

double table_candela(int plane, int angle) { return 100 + 37 * ((plane % 12) * 7 % 5) + 11 * ((angle * 5) % 17); }

/// The table as LM-63 text, absolute photometry.
std::string table_file() {
  std::string text = "IESNA:LM-63-2002\n[TEST] bench\n[MANUFAC] none\nTILT=NONE\n";
  text += fmt::format("1 -1 1 {} {} 1 2 0 0 0\n1 1 10\n", kAngles, kPlanes);
  for (int a = 0; a < kAngles; ++a) text += fmt::format("{} ", 5 * a);
  text += '\n';
  for (int p = 0; p < kPlanes; ++p) text += fmt::format("{} ", 30 * p);
  text += '\n';
  for (int p = 0; p < kPlanes; ++p) {
    for (int a = 0; a < kAngles; ++a) text += fmt::format("{} ", table_candela(p, a));
    text += '\n';
  }
  return text;
}

double between_candela(double gamma_rad, double c_rad) {
  const double a = deg_from_rad(gamma_rad) / 5, p = deg_from_rad(c_rad) / 30;
  const int a0 = std::min(static_cast<int>(a), kAngles - 2), p0 = std::min(static_cast<int>(p), kPlanes - 2);
  const double u = a - a0, v = p - p0;
  return (1 - u) * (1 - v) * table_candela(p0, a0) + u * (1 - v) * table_candela(p0, a0 + 1) +
         (1 - u) * v * table_candela(p0 + 1, a0) + u * v * table_candela(p0 + 1, a0 + 1);
}

/// Receivers on a sphere around the lamp, in the table's own directions: the file's values, to the candela.
AnalyticCase on_the_grid(const Intensity& intensity, const Mat3& turn) {
  AnalyticCase one;
  one.name = "ies-on-grid";
  one.direct_target = kPointTarget;
  const Vec3 lamp_m(1, 2, 3);
  one.emitters.push_back({intensity, {turn, lamp_m}});
  for (int p = 0; p + 1 < kPlanes; ++p)
    for (int a = 1; a < kAngles - 1; ++a) {  // not straight down: all planes meet there, and the table's may differ
      const double gamma = rad_from_deg(5 * a), c = rad_from_deg(30 * p);
      const Vec3 leaving = turn * Vec3(std::sin(gamma) * std::cos(c), std::sin(gamma) * std::sin(c), -std::cos(gamma));
      one.receivers.push_back({lamp_m + 2 * leaving, -leaving});
      one.exact_lx.push_back(table_candela(p, a) / 4.0);
    }
  return one;
}

}  // namespace

void add_point_rows(const BenchOptions& options, std::vector<BenchRow>& rows) {
  add_pairs(options, rows);
  const Mat3 turn = (Eigen::AngleAxisd(0.7, Vec3::UnitZ()) * Eigen::AngleAxisd(0.4, Vec3::UnitX())).toRotationMatrix();
  measure_case(over_a_floor("lambertian", make_lambertian(kPoint_lm), turn, cosine_power<1>), options, rows);
  measure_case(over_a_floor("cosine-power-4", make_cosine_power(kPoint_lm, 4), turn, cosine_power<4>), options, rows);
  measure_case(over_a_floor("cosine-power-60", make_cosine_power(kPoint_lm, 60), turn, cosine_power<60>), options,
               rows);
  measure_case(over_a_floor("spot-30-54", make_spot(kPoint_lm, rad_from_deg(30), rad_from_deg(54)), turn, spot_candela),
               options, rows);
  const auto file = parse_ies(table_file(), "bench.ies");
  if (!file) {
    Measured none;
    none.refused = file.error().front().text();
    rows.push_back(row_of("ies-on-grid", "-", 0, none, std::nullopt, std::nullopt));
    return;
  }
  const Intensity table = make_intensity(*file);
  measure_case(on_the_grid(table, turn), options, rows);
  measure_case(over_a_floor("ies-between", table, Mat3::Identity(), between_candela), options, rows);
}

}  // namespace luxrig
