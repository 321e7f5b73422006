/// The simulated Modbus TCP server: the same bytes in one piece and in pieces must give the same answers; every answer
/// is a whole frame that matches its request; a spoiled answer always differs from the good one.
#include <algorithm>
#include <cstdlib>
#include <map>
#include <vector>

#include "sim/wire/modbus/modbus_session.h"

namespace {

using namespace luxrig::sim;
using Bytes = std::vector<std::uint8_t>;

// Units 0 to 31 have holding registers 0 to 199, which accept any value below 0xff00.
class Units final : public ModbusUnits {
 public:
  bool has(int unit) const override { return unit < 32; }
  std::optional<ModbusException> read(int unit, RegisterKind kind, int first,
                                      std::span<std::uint16_t> values) override {
    if (kind == RegisterKind::coil || kind == RegisterKind::discrete) {
      for (std::size_t i = 0; i < values.size(); ++i) values[i] = coils_[{unit, first + static_cast<int>(i)}];
      return std::nullopt;
    }
    if (kind == RegisterKind::input || first + static_cast<int>(values.size()) > 200) {
      return ModbusException::illegal_address;
    }
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = registers_[{unit, first + static_cast<int>(i)}];
    return std::nullopt;
  }
  std::optional<ModbusException> write(int unit, int first, std::span<const std::uint16_t> values) override {
    if (values.empty() || first < 0 || first + values.size() > 65536) std::abort();
    if (first + static_cast<int>(values.size()) > 200) return ModbusException::illegal_address;
    for (const std::uint16_t value : values) {
      if (value >= 0xff00) return ModbusException::illegal_value;
    }
    for (std::size_t i = 0; i < values.size(); ++i) registers_[{unit, first + static_cast<int>(i)}] = values[i];
    return std::nullopt;
  }
  bool has_bits(int unit) const override { return unit % 2 == 0; }
  std::optional<ModbusException> write_coils(int unit, int first, std::span<const std::uint16_t> bits) override {
    if (bits.empty() || first < 0 || first + bits.size() > 65536) std::abort();
    for (std::size_t i = 0; i < bits.size(); ++i) {
      if (bits[i] > 1) std::abort();
      coils_[{unit, first + static_cast<int>(i)}] = bits[i];
    }
    return std::nullopt;
  }

 private:
  std::map<std::pair<int, int>, std::uint16_t> registers_, coils_;
};

void check(const Bytes& reply) {
  if (reply.size() < 9 || reply.size() > 260 || reply[2] != 0 || reply[3] != 0) std::abort();
  if (static_cast<std::size_t>(reply[4] << 8 | reply[5]) != reply.size() - 6) std::abort();
  if ((reply[7] & 0x80) != 0) {
    if (reply.size() != 9 || reply[8] < 1 || reply[8] > 11) std::abort();
  } else if (reply[7] >= 1 && reply[7] <= 4) {
    if (reply.size() != 9u + reply[8]) std::abort();
  } else if ((reply[7] != 5 && reply[7] != 6 && reply[7] != 15 && reply[7] != 16) || reply.size() != 12) {
    std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::size_t piece = 1 + data[0];
  const std::uint64_t random = data[1] * 0x9e3779b97f4a7c15u;
  const std::span<const std::uint8_t> stream(data + 2, size - 2);

  Units units;
  ModbusSession session;
  std::vector<Bytes> whole;
  for (const ModbusReply& reply : session.receive(stream, units)) whole.push_back(reply.bytes);
  for (const Bytes& reply : whole) {
    check(reply);
    if (garbled_reply(reply, random) == reply) std::abort();
  }

  Units same_units;
  ModbusSession in_pieces;
  std::vector<Bytes> pieces;
  for (std::size_t at = 0; at < stream.size(); at += piece) {
    // On the heap, so that a read past its end is found.
    const auto part = stream.subspan(at, std::min(piece, stream.size() - at));
    for (const ModbusReply& reply : in_pieces.receive(Bytes(part.begin(), part.end()), same_units)) {
      pieces.push_back(reply.bytes);
    }
  }
  if (pieces != whole || in_pieces.broken() != session.broken()) std::abort();
  return 0;
}
