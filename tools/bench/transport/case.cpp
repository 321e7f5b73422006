#include "tools/bench/transport/case.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdio>
#include <fstream>

namespace luxrig {
namespace {

/// FNV-1a over the bytes of numbers.
class Hash {
 public:
  void add(std::uint64_t word) {
    for (int k = 0; k < 8; ++k) bits_ = (bits_ ^ ((word >> (8 * k)) & 0xff)) * 0x100000001b3ULL;
  }
  void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
  void add(const Vec3& v) {
    for (int k = 0; k < 3; ++k) add(v[k]);
  }
  [[nodiscard]] std::uint64_t bits() const { return bits_; }

 private:
  std::uint64_t bits_ = 0xcbf29ce484222325ULL;
};

/// One number per line: its wanted error, its own error, then the lux of each receiver.
std::filesystem::path file_of(const TransportCase& one, const BenchOptions& options, const ReferenceLevels& levels) {
  Hash of_levels;
  for (const double level : levels.wanted) of_levels.add(level);
  for (const double level : levels.steering) of_levels.add(level);
  of_levels.add(levels.floor);
  const bool all_one = levels.wanted.empty() && levels.steering.empty();
  return options.references_folder /
         fmt::format("{}-{:016x}.txt", one.room.name, hash_of(one.room) ^ (all_one ? 0 : of_levels.bits()));
}

std::optional<Reference> read_reference(const std::filesystem::path& file, std::size_t receivers, double wanted) {
  std::ifstream in(file);
  Reference reference;
  double wanted_there = 0;
  if (!(in >> wanted_there >> reference.rms_error) || wanted_there > wanted) return std::nullopt;
  reference.lux.resize(static_cast<Eigen::Index>(receivers));
  for (double& lux : reference.lux)
    if (!(in >> lux) || !std::isfinite(lux)) return std::nullopt;
  return reference;
}

}  // namespace

bool wanted_case(const BenchOptions& options, const std::string& case_name) {
  return case_name.compare(0, options.only.size(), options.only) == 0;
}

std::uint64_t hash_of(const LitRoom& room) {
  Hash hash;
  const Scene& scene = room.scene;
  hash.add(scene.origin_world_m);
  for (const Vec3f& v : scene.vertices_m) hash.add(Vec3(v.cast<double>()));
  for (const auto& t : scene.triangles)
    for (const std::uint32_t index : t) hash.add(std::uint64_t{index});
  for (const std::uint32_t m : scene.material_of_triangle) hash.add(std::uint64_t{m});
  for (const Material& m : scene.materials) {
    hash.add(m.reflectance_rgb);
    hash.add(m.specular_reflectance);
    hash.add(m.roughness);
  }
  for (const Emitter& e : room.emitters) {
    hash.add(e.colour_rgb);
    hash.add(e.world_from_lamp.translation_m);
    hash.add(std::uint64_t(e.shape.kind));
    hash.add(e.shape.size_m);
    // Hash the distribution by its intensities over a spiral.
    for (int i = 0; i < 64; ++i) {
      const double z = 1 - (2 * i + 1) / 64.0, flat = std::sqrt(1 - z * z), turn = 2.399963 * i;
      const Vec3 direction(flat * std::cos(turn), flat * std::sin(turn), z);
      if (e.sky) hash.add(e.sky->luminance_cd_m2(direction));
      if (e.intensity) hash.add(e.intensity->intensity_cd(e.world_from_lamp.inverse_direction(direction)));
    }
  }
  for (const Receiver& r : room.receivers) hash.add(r.position_world_m), hash.add(r.normal_world);
  return hash.bits();
}

RoomError error_of(const Eigen::VectorXd& lux, const Eigen::VectorXd& reference_lux, double floor) {
  const double min_lx = floor * reference_lux.mean();
  const Eigen::ArrayXd relative = (lux - reference_lux).array() / reference_lux.array().max(min_lx);
  return {std::sqrt(relative.square().mean()), relative.mean()};
}

Reference reference_of(const TransportCase& one, const BenchOptions& options, const ReferenceLevels& of_lamps) {
  const double wanted = options.quick ? 0.0016 : options.reference_error;
  if (!options.references_folder.empty())
    if (auto kept = read_reference(file_of(one, options, of_lamps), one.room.receivers.size(), wanted)) return *kept;
  fmt::print(stderr, "{}: converged reference, wanted error {:g} …\n", one.room.name, wanted);
  EvaluateOptions evaluate;
  evaluate.wanted_rms_error = wanted;
  evaluate.seed = 0xC0FFEE;
  evaluate.threads = options.threads;
  evaluate.levels = of_lamps.steering;
  evaluate.max_rays = options.quick ? 30'000'000 : 20'000'000'000;
  const Method path = {"path", make_path_evaluator, true, 0};
  const Measured run = measure(path, one.rays, one.room.receivers, one.room.emitters, evaluate);
  Reference reference;
  reference.refused = run.refused;
  if (!run.refused.empty()) return reference;
  Eigen::VectorXd levels = Eigen::VectorXd::Ones(run.matrix.emitters());
  for (std::size_t e = 0; e < of_lamps.wanted.size(); ++e) levels[static_cast<Eigen::Index>(e)] = of_lamps.wanted[e];
  reference.lux = run.matrix.lux(levels);
  const Eigen::ArrayXd bars = run.matrix.standard_error_lux(levels).array();
  reference.rms_error =
      std::sqrt((bars / reference.lux.array().max(of_lamps.floor * reference.lux.mean())).square().mean());
  reference.seconds = run.seconds;
  if (!options.references_folder.empty() && !options.quick) {
    std::filesystem::create_directories(options.references_folder);
    std::ofstream out(file_of(one, options, of_lamps));
    out << fmt::format("{:.17g}\n{:.17g}\n", wanted, reference.rms_error);
    for (const double lux : reference.lux) out << fmt::format("{:.17g}\n", lux);
    out.close();
    if (!out)
      fmt::print(stderr, "{}:0:0: cannot be written: name a folder that can be\n",
                 file_of(one, options, of_lamps).string());
  }
  return reference;
}

void set_note(BenchRow& row, std::string note) {
  for (char& c : note)
    if (c == ',' || c == '\n') c = ';';
  row.further.back().second = std::move(note);
}

BenchRow transport_row(const std::string& case_name, const std::string& method, double error, const Measured& run,
                       std::optional<double> wanted_error, std::optional<double> target_error, const RoomError& bias,
                       double reference_error) {
  BenchRow row = row_of(case_name, method, error, run, wanted_error, target_error);
  const auto note = row.further.back();
  row.further.pop_back();
  row.further.emplace_back("bias", bias.bias != 0 ? fmt::format("{:.3g}", bias.bias) : "");
  row.further.emplace_back("reference_error", reference_error != 0 ? fmt::format("{:.3g}", reference_error) : "");
  row.further.emplace_back("cpu_seconds", run.cpu_seconds > 0 ? fmt::format("{:.3g}", run.cpu_seconds) : "");
  row.further.push_back(note);
  return row;
}

}  // namespace luxrig
