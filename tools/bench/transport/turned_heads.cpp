/// Heads of a museum's rig turn: what compute_transport costs with the light before the turn, and without it, at the
/// same wanted error of all light.

#include <fmt/format.h>

#include <cmath>

#include "core/rig/rig_file.h"
#include "core/tasks/session.h"
#include "tools/bench/aisles_rig.h"
#include "tools/bench/transport/case.h"

namespace luxrig {
namespace {

constexpr int kSpots = 60, kWorks = 50;
constexpr double kWantedRms = 0.01, kReferenceRms = 0.002;
constexpr double kTurn_rad = 0.2;

Result<Session> aisles() {
  auto rig = parse_rig(aisles_rig_text(kSpots, kWorks), "aisles/rig.toml", ".");
  if (!rig) return refusal(rig.error().front().text());
  auto session = session_of(std::move(*rig));
  if (!session) return refusal(session.error().front().text());
  return std::move(*session);
}

/// `heads` of them look elsewhere, spread over the rig.
Look turned(const Session& session, int heads) {
  Look look = hung_look(session.rig);
  for (int k = 0; k < heads; ++k) look.joints[static_cast<std::size_t>(k * kSpots / heads)].tilt_rad += kTurn_rad;
  return look;
}

}  // namespace

void add_turned_head_rows(const BenchOptions& options, std::vector<BenchRow>& rows) {
  const std::string name = fmt::format("turned-heads-{}x{}", kSpots, kWorks);
  if (!wanted_case(options, name)) return;
  const Result<Session> session = aisles();
  if (!session) {
    fmt::print(stderr, "{}: {}\n", name, session.error().detail);
    return;
  }
  ComputeOptions compute;
  compute.threads = options.threads;
  compute.max_error = kWantedRms;
  compute.max_seconds = 0;
  const auto before = compute_transport(*session, compute);
  if (!before) return;
  const std::vector<Joints> hung = hung_look(session->rig).joints;
  const KeptTransport known{hung, *before};
  for (const int heads : {1, 6, 30}) {
    const Look look = turned(*session, heads);
    ComputeOptions converged = compute;
    converged.max_error = options.quick ? 2 * kReferenceRms : kReferenceRms;
    converged.seed = 1000;
    const auto reference = compute_transport(*session, converged, look);
    if (!reference) return;
    const Eigen::VectorXd all_on = Eigen::VectorXd::Ones(reference->emitters());
    for (const bool kept : {false, true}) {
      std::vector<CallSeconds> took;
      std::vector<double> rms, bias;
      Measured run;
      ModelUsed used;
      for (std::uint64_t seed = 1; seed <= (options.quick ? 1u : 3u); ++seed) {
        compute.seed = seed;
        Result<TransportMatrix> light = TransportMatrix{};
        took.push_back(
            timed([&] { light = compute_transport(*session, compute, look, &used, kept ? &known : nullptr); }));
        if (!light) return;
        const RoomError error = error_of(light->lux(all_on), reference->lux(all_on));
        rms.push_back(error.rms), bias.push_back(error.bias);
        run.matrix = std::move(*light);
      }
      const CallSeconds middle = median_of(took);
      run.seconds = middle.wall;
      run.cpu_seconds = middle.cpu;
      rows.push_back(transport_row(fmt::format("{}-{}", name, heads), kept ? "kept" : "all", median_of(rms), run,
                                   kWantedRms, std::nullopt, {median_of(rms), median_of(bias)}, reference->rms_error));
      set_note(rows.back(), fmt::format("rms {:.2g} by its own account; {}", used.rms_error, used.reason));
    }
  }
}

}  // namespace luxrig
