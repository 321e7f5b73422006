// Any bytes as the stored light of a rig, as they are and with a valid head and checksum: never a throw; accepted light
// is finite, of the rig's sizes, and is written and read back the same.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "core/check.h"
#include "tools/luxrigd/state/light_store.h"

namespace {

constexpr std::uint64_t kKey = 42;

luxrig::Rig rig_of(std::size_t fixtures, std::size_t points, std::size_t meters) {
  luxrig::Rig rig;
  rig.fixtures.resize(fixtures);
  rig.points.resize(points);
  rig.luxmeters.resize(meters);
  return rig;
}

template <class Matrix>
void check_matrix(const Matrix& matrix, std::size_t rows, std::size_t columns) {
  if (matrix.size() == 0) return;
  LUXRIG_CHECK(static_cast<std::size_t>(matrix.rows()) == rows && static_cast<std::size_t>(matrix.cols()) == columns,
               "{} x {} in place of {} x {}", matrix.rows(), matrix.cols(), rows, columns);
  LUXRIG_CHECK(matrix.allFinite(), "a number is not finite");
}

bool check_bytes(const std::string& bytes, const luxrig::Rig& rig) {
  const auto light = luxrig::light_of_bytes(bytes, kKey, rig);
  if (!light) return false;
  const std::size_t lights = rig.fixtures.size(), points = rig.points.size(), meters = rig.luxmeters.size();
  LUXRIG_CHECK(light->joints.size() == lights, "{} joints for {} fixtures", light->joints.size(), lights);
  for (const luxrig::Joints& joints : light->joints)
    LUXRIG_CHECK(std::isfinite(joints.pan_rad) && std::isfinite(joints.tilt_rad) && std::isfinite(joints.beam_rad),
                 "an angle is not finite");
  const luxrig::LightModel& model = light->model;
  check_matrix(model.point_lux_per_level, points, lights);
  check_matrix(model.meter_lux_per_level, meters, lights);
  check_matrix(model.point_standard_error, points, lights);
  check_matrix(model.meter_standard_error, meters, lights);
  check_matrix(model.point_fixed_lx, points, 1);
  check_matrix(model.meter_fixed_lx, meters, 1);
  check_matrix(model.point_fixed_error_lx, points, 1);
  check_matrix(model.meter_fixed_error_lx, meters, 1);
  const std::string written = luxrig::light_bytes(*light, kKey);
  const auto again = luxrig::light_of_bytes(written, kKey, rig);
  LUXRIG_CHECK(again.has_value(), "own bytes refused");
  LUXRIG_CHECK(luxrig::light_bytes(*again, kKey) == written, "not the same when written again");
  return true;
}

/// The head of a light of these fixtures, the fuzzed words, and their correct checksum.
std::string with_head_and_sum(const std::uint8_t* data, std::size_t size, const luxrig::Rig& rig) {
  // The head is what light_bytes writes: a magic number, the key and the number of fixtures.
  const std::string head = luxrig::light_bytes({std::vector<luxrig::Joints>(rig.fixtures.size()), {}}, kKey);
  std::vector<std::uint64_t> words(3 + size / sizeof(std::uint64_t));
  std::memcpy(words.data(), head.data(), 3 * sizeof words[0]);
  if (words.size() > 3) std::memcpy(words.data() + 3, data, (words.size() - 3) * sizeof words[0]);
  words.push_back(luxrig::light_sum(words));
  return {reinterpret_cast<const char*>(words.data()), words.size() * sizeof words[0]};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  for (std::size_t fixtures = 0; fixtures <= 2; ++fixtures) {
    for (const auto& [points, meters] : {std::pair{0u, 0u}, {1u, 0u}, {2u, 1u}}) {
      const luxrig::Rig rig = rig_of(fixtures, points, meters);
      check_bytes(bytes, rig);
      check_bytes(with_head_and_sum(data, size, rig), rig);
    }
  }
  return 0;
}
