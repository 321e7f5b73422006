#include <algorithm>

#include "sim/wire/modbus/modbus_rtu_session.h"
#include "sim/wire/modbus/pty_line.h"
#include "sim/wire/modbus/rig_units.h"

namespace luxrig::sim {
namespace {

class ModbusRtuEndpoint final : public BusEndpoint {
 public:
  ModbusRtuEndpoint(const EndpointParts& parts, std::unique_ptr<PtyLine> line)
      : parts_(parts), units_(parts), line_(std::move(line)) {}

  [[nodiscard]] int port() const override { return 0; }
  [[nodiscard]] std::string path() const override { return line_->path(); }

  void serve(Time now) override {
    units_.advance(now);
    const bool dead = parts_.faults.find(parts_.rig.buses[parts_.bus].name, FaultKind::dead).has_value();
    line_->set_open(!dead);
    if (!line_->is_open()) {
      waiting_.clear();
      session_.forget();
      return;
    }
    for (LinePiece& piece : session_.receive(now, line_->take(), units_)) waiting_.push_back(std::move(piece));
    std::stable_sort(waiting_.begin(), waiting_.end(),
                     [](const LinePiece& a, const LinePiece& b) { return a.due < b.due; });
    const auto later = std::find_if(waiting_.begin(), waiting_.end(), [&](const LinePiece& p) { return p.due > now; });
    std::for_each(waiting_.begin(), later, [&](const LinePiece& piece) { line_->put(piece.bytes); });
    waiting_.erase(waiting_.begin(), later);
    if (waiting_.size() > kMaxPieces) waiting_.clear();
  }

  void descriptors(std::vector<int>& into) const override {
    if (line_->is_open()) into.push_back(line_->descriptor());
  }

 private:
  static constexpr std::size_t kMaxPieces = 256;

  EndpointParts parts_;
  RigUnits units_;
  std::unique_ptr<PtyLine> line_;
  ModbusRtuSession session_;
  std::vector<LinePiece> waiting_;
};

}  // namespace

Result<std::unique_ptr<BusEndpoint>> open_modbus_rtu_endpoint(const EndpointParts& parts, const EndpointPlace& place) {
  auto line = PtyLine::open(place.path);
  if (!line) return tl::unexpected(line.error());
  return std::make_unique<ModbusRtuEndpoint>(parts, std::move(*line));
}

}  // namespace luxrig::sim
