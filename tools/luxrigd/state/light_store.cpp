#include "tools/luxrigd/state/light_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <span>

#include "core/tasks/rig_version.h"
#include "tools/process/files.h"

namespace luxrig {
namespace {

constexpr std::uint64_t kLightMagic = 0x31544847494c584c;  // "LXLIGHT1"
constexpr std::string_view kLightFile = "light.bin";

template <class Visit>
void each_matrix(LightModel& model, Visit visit) {
  for (Eigen::MatrixXd* matrix : {&model.point_lux_per_level, &model.meter_lux_per_level, &model.point_standard_error,
                                  &model.meter_standard_error})
    visit(*matrix);
  for (Eigen::VectorXd* column :
       {&model.point_fixed_lx, &model.meter_fixed_lx, &model.point_fixed_error_lx, &model.meter_fixed_error_lx})
    visit(*column);
}

class WordReader {
 public:
  explicit WordReader(std::span<const std::uint64_t> words) : words_(words) {}
  std::uint64_t word() {
    if (next_ >= words_.size()) {
      bad_ = true;
      return 0;
    }
    return words_[next_++];
  }
  double number() {
    const double value = std::bit_cast<double>(word());
    bad_ = bad_ || !std::isfinite(value);
    return value;
  }
  /// Rows, columns, then entries by columns. It must have these sizes, or be empty.
  template <class Matrix>
  void matrix(Matrix& into, std::size_t rows, std::size_t columns) {
    const std::uint64_t its_rows = word(), its_columns = word();
    if (its_rows == 0 || its_columns == 0) return;
    if (its_rows != rows || its_columns != columns ||
        (words_.size() - next_) / std::max<std::size_t>(1, rows) < columns) {
      bad_ = true;
      return;
    }
    into.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
    for (Eigen::Index i = 0; i < into.size(); ++i) into.data()[i] = number();
  }
  [[nodiscard]] bool good() const { return !bad_ && next_ == words_.size(); }

 private:
  std::span<const std::uint64_t> words_;
  std::size_t next_ = 0;
  bool bad_ = false;
};

}  // namespace

std::uint64_t light_sum(std::span<const std::uint64_t> words) {
  // FNV-1a by words.
  std::uint64_t sum = 0xcbf29ce484222325U;
  for (const std::uint64_t word : words) sum = (sum ^ word ^ (word >> 32U)) * 0x100000001b3U;
  return sum;
}

std::uint64_t light_key(const Rig& rig, const Scene& scene, const ComputeOptions& compute,
                        const std::filesystem::path& program) {
  std::error_code error;
  const auto written = std::filesystem::last_write_time(program, error).time_since_epoch().count();
  const auto size = std::filesystem::file_size(program, error);
  const std::string asked = fmt::format("{} {} {} {} {} {} {} {}", static_cast<int>(compute.model), compute.max_error,
                                        compute.worst_error.value_or(-1), compute.error_floor_lx.value_or(-1),
                                        compute.max_seconds, compute.seed, written, size);
  std::uint64_t key = version_of(rig, scene).light;
  for (const char c : asked) key = (key ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return key;
}

std::string light_bytes(const KeptLight& light, std::uint64_t key) {
  std::vector<std::uint64_t> words = {kLightMagic, key, light.joints.size()};
  for (const Joints& joints : light.joints)
    for (const double angle : {joints.pan_rad, joints.tilt_rad, joints.beam_rad})
      words.push_back(std::bit_cast<std::uint64_t>(angle));
  LightModel model = light.model;
  each_matrix(model, [&](const auto& matrix) {
    words.push_back(static_cast<std::uint64_t>(matrix.rows()));
    words.push_back(static_cast<std::uint64_t>(matrix.cols()));
    for (Eigen::Index i = 0; i < matrix.size(); ++i) words.push_back(std::bit_cast<std::uint64_t>(matrix.data()[i]));
  });
  words.push_back(light_sum(words));
  return {reinterpret_cast<const char*>(words.data()), words.size() * sizeof words[0]};
}

std::optional<KeptLight> light_of_bytes(std::string_view bytes, std::uint64_t key, const Rig& rig) {
  std::vector<std::uint64_t> words(bytes.size() / sizeof(std::uint64_t));
  if (words.size() < 4 || bytes.size() % sizeof words[0] != 0) return std::nullopt;
  std::memcpy(words.data(), bytes.data(), bytes.size());
  const std::uint64_t sum = words.back();
  words.pop_back();
  if (sum != light_sum(words) || words[0] != kLightMagic || words[1] != key || words[2] != rig.fixtures.size())
    return std::nullopt;
  WordReader reader(std::span<const std::uint64_t>(words).subspan(3));
  KeptLight light;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    Joints joints;
    for (double* angle : {&joints.pan_rad, &joints.tilt_rad, &joints.beam_rad}) *angle = reader.number();
    light.joints.push_back(joints);
  }
  const std::size_t points = rig.points.size(), meters = rig.luxmeters.size(), lights = rig.fixtures.size();
  LightModel& model = light.model;
  reader.matrix(model.point_lux_per_level, points, lights);
  reader.matrix(model.meter_lux_per_level, meters, lights);
  reader.matrix(model.point_standard_error, points, lights);
  reader.matrix(model.meter_standard_error, meters, lights);
  reader.matrix(model.point_fixed_lx, points, 1);
  reader.matrix(model.meter_fixed_lx, meters, 1);
  reader.matrix(model.point_fixed_error_lx, points, 1);
  reader.matrix(model.meter_fixed_error_lx, meters, 1);
  if (!reader.good()) return std::nullopt;
  return light;
}

void keep_light(const std::filesystem::path& folder, const KeptLight& light, std::uint64_t key) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  (void)write_file(folder / kLightFile, light_bytes(light, key));
}

std::optional<KeptLight> kept_light(const std::filesystem::path& folder, std::uint64_t key, const Rig& rig) {
  std::error_code error;
  if (!std::filesystem::exists(folder / kLightFile, error)) return std::nullopt;
  const auto text = read_file(folder / kLightFile);
  if (!text) return std::nullopt;
  return light_of_bytes(*text, key, rig);
}

}  // namespace luxrig
