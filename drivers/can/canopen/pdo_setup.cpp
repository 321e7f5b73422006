#include "drivers/can/canopen/pdo_setup.h"

#include "core/check.h"
#include "drivers/can/canopen/cob_id.h"

namespace luxrig::canopen {
namespace {

constexpr std::uint32_t kPdoOff = 0x80000000;

std::uint16_t parameter_of(PdoDirection direction, int number) {
  return static_cast<std::uint16_t>((direction == PdoDirection::to_node ? 0x1400 : 0x1800) + number - 1);
}

std::uint32_t cob_id_of(PdoDirection direction, int number, int node) {
  return (direction == PdoDirection::to_node ? kReceivePdo1 : kTransmitPdo1) +
         kNextPdo * static_cast<std::uint32_t>(number - 1) + static_cast<std::uint32_t>(node);
}

}  // namespace

std::vector<std::uint8_t> little_endian(std::uint32_t value, int bytes) {
  std::vector<std::uint8_t> out;
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  return out;
}

SdoRequest pdo_off(PdoDirection direction, int number, int node) {
  return {{parameter_of(direction, number), 1}, little_endian(cob_id_of(direction, number, node) | kPdoOff, 4)};
}

std::vector<SdoRequest> pdo_setup(PdoDirection direction, int number, int node, int transmission,
                                  const std::vector<MappedObject>& mapped) {
  LUXRIG_CHECK(number >= 1 && number <= 4 && node >= 1 && node <= 127, "PDO {} of node {}", number, node);
  const std::uint16_t parameter = parameter_of(direction, number);
  const auto mapping = static_cast<std::uint16_t>(parameter + 0x200);
  std::vector<SdoRequest> writes = {pdo_off(direction, number, node), {{mapping, 0}, little_endian(0, 1)}};
  int bits = 0;
  for (std::size_t i = 0; i < mapped.size(); ++i) {
    const MappedObject& entry = mapped[i];
    bits += entry.bits;
    writes.push_back(
        {{mapping, static_cast<std::uint8_t>(i + 1)},
         little_endian(static_cast<std::uint32_t>(entry.object.index) << 16 |
                           static_cast<std::uint32_t>(entry.object.sub) << 8 | static_cast<std::uint32_t>(entry.bits),
                       4)});
  }
  LUXRIG_CHECK(bits <= 64, "{} bits in a PDO", bits);
  writes.push_back({{mapping, 0}, little_endian(static_cast<std::uint32_t>(mapped.size()), 1)});
  writes.push_back({{parameter, 2}, little_endian(static_cast<std::uint32_t>(transmission), 1)});
  writes.push_back({{parameter, 1}, little_endian(cob_id_of(direction, number, node), 4)});
  return writes;
}

}  // namespace luxrig::canopen
