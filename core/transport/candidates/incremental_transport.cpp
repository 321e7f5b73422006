#include "core/transport/candidates/incremental_transport.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>

#include "core/parallel.h"
#include "core/transport/candidates/reflected/indirect_plan.h"
#include "core/transport/direct/emitter_sampler.h"

namespace luxrig {
namespace {

Result<void> check_point_luminaire(const Emitter& emitter) {
  if (auto checked = check_evaluation({}, std::span(&emitter, 1), {}); !checked) return checked;
  if (emitter.sky) return refusal("the emitter is a sky, not a luminaire");
  if (emitter.shape.kind != LuminousShape::Kind::point)
    return refusal(
        "the luminaire has a size; take its far field as a point, or evaluate it with core/transport/evaluator.h");
  return {};
}

/// Whether the segment meets the box, ends included (slabs; T. Kay and J. Kajiya, 1986).
bool meets(const Eigen::AlignedBox3d& box, const Vec3& from, const Vec3& to) {
  double begin = 0, end = 1;
  for (int k = 0; k < 3; ++k) {
    const double way = to[k] - from[k];
    if (way == 0) {
      if (from[k] < box.min()[k] || from[k] > box.max()[k]) return false;
      continue;
    }
    double a = (box.min()[k] - from[k]) / way, b = (box.max()[k] - from[k]) / way;
    if (a > b) std::swap(a, b);
    begin = std::max(begin, a);
    end = std::min(end, b);
  }
  return begin <= end;
}

class Incremental final : public IncrementalTransport {
 public:
  Incremental(const Scene& scene, const RayScene& rays, std::span<const Receiver> receivers,
              const IncrementalOptions& options)
      : scene_(scene), rays_(rays), receivers_(receivers.begin(), receivers.end()), options_(options) {
    options_.watch = {};  // only for make()
    if (!scene_.triangles.empty()) blockers_ = std::make_unique<Blockers>(scene_);
    visibility_ = {blockers_ ? &rays_ : nullptr, blockers_.get()};
  }

  Result<void> prepare(const Run& run) {
    if (!options_.indirect || !blockers_ || receivers_.empty()) return {};
    CandidateOptions wanted;
    wanted.run() = run;
    IndirectSettings settings;
    settings.cell_m = cell_size_m(scene_, options_.cells);
    settings.keep_links = true;
    settings.rays_per_cell = options_.rays_per_cell / 3;
    settings.guided_rays_per_cell = options_.rays_per_cell - settings.rays_per_cell;
    auto fields = importance_fields(scene_, visibility_, receivers_, {}, settings, wanted);
    if (!fields) return tl::unexpected(std::move(fields.error()));
    for (const auto& field : *fields) rays_cast_ += field->rays();
    indirect_ =
        std::make_unique<IndirectColumns>(rays_, std::move(*fields), flatness_error(options_.cells), options_.seed);
    return {};
  }

  Result<LuminaireColumn> direct_column(const Emitter& emitter) const override {
    if (auto checked = check_point_luminaire(emitter); !checked) return tl::unexpected(std::move(checked.error()));
    return direct(luminaires_ready(std::span(&emitter, 1)).front());
  }

  Result<LuminaireColumn> column(const Emitter& emitter) const override {
    if (auto checked = check_point_luminaire(emitter); !checked) return tl::unexpected(std::move(checked.error()));
    const CandidateLuminaire luminaire = luminaires_ready(std::span(&emitter, 1)).front();
    LuminaireColumn column = direct(luminaire);
    if (!indirect_) return column;
    const Vec3& at_m = luminaire.offset_world_m;
    const DirectionGuide guide = indirect_->guide(luminaire, std::span(&at_m, 1), column.rays);
    std::vector<float> replicates(IndirectColumns::kReplicates * indirect_->stride()), lux(receivers_.size()),
        error_lux(receivers_.size());
    constexpr auto kReplicates = static_cast<std::uint32_t>(IndirectColumns::kReplicates);
    column.rays +=
        indirect_->evaluate(luminaire, at_m, guide, {options_.rays_per_column / kReplicates, 0, false}, replicates);
    indirect_->summarise(replicates, {}, lux, error_lux);
    for (std::size_t r = 0; r < receivers_.size(); ++r) {
      const auto row = static_cast<Eigen::Index>(r);
      column.total_lux[row] += static_cast<double>(lux[r]);
      column.standard_error_lux[row] = static_cast<double>(error_lux[r]);
    }
    return column;
  }

  Result<void> move_receiver(std::size_t receiver, const Receiver& to) override {
    if (receiver >= receivers_.size())
      return refusal(fmt::format("receiver {} of {} cannot be moved", receiver, receivers_.size()));
    if (auto checked = check_evaluation(std::span(&to, 1), {}, {}); !checked) return checked;
    receivers_[receiver] = to;
    rays_cast_ = 0;
    if (!indirect_) return {};
    auto& fields = indirect_->fields();
    parallel_for(fields.size(), options_.threads,
                 [&](std::size_t k) { fields[k]->update_receiver(visibility_, receiver, {}); });
    for (const auto& field : fields) rays_cast_ += field->rays();
    return {};
  }

  Result<std::uint64_t> update_direct(std::span<const Emitter> emitters, const RayScene& rays,
                                      const Eigen::AlignedBox3d& changed_world_m, Eigen::MatrixXd& lux) const override {
    for (const Emitter& emitter : emitters)
      if (auto checked = check_point_luminaire(emitter); !checked) return tl::unexpected(std::move(checked.error()));
    if (lux.rows() != static_cast<Eigen::Index>(receivers_.size()) ||
        lux.cols() != static_cast<Eigen::Index>(emitters.size()))
      return refusal(fmt::format("lux is {} × {} for {} receivers and {} luminaires", lux.rows(), lux.cols(),
                                 receivers_.size(), emitters.size()));
    if (changed_world_m.isEmpty()) return 0;
    if (!changed_world_m.min().allFinite() || !changed_world_m.max().allFinite())
      return refusal("the box in which the scene changed is not finite");
    const auto luminaires = luminaires_ready(emitters);
    std::atomic<std::uint64_t> cast{0};
    parallel_for(receivers_.size(), options_.threads, [&](std::size_t r) {
      std::uint64_t of_row = 0;
      for (std::size_t e = 0; e < luminaires.size(); ++e) {
        const Vec3& at_m = luminaires[e].offset_world_m;
        if (!meets(changed_world_m, receivers_[r].position_world_m, at_m)) continue;
        double now = unobstructed_lux(luminaires[e], at_m, receivers_[r]);
        if (now > 0) {
          ++of_row;
          now *= rays.occluded(receivers_[r].position_world_m, receivers_[r].normal_world, at_m)
                     ? 0
                     : rays.transmittance(receivers_[r].position_world_m, at_m);
        }
        lux(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(e)) = now;
      }
      cast += of_row;
    });
    return cast.load();
  }

  std::uint64_t rays() const override { return rays_cast_; }
  std::size_t bytes() const override {
    return receivers_.size() * sizeof(Receiver) + (indirect_ ? indirect_->bytes() : 0);
  }

 private:
  LuminaireColumn direct(const CandidateLuminaire& luminaire) const {
    const auto rows = static_cast<Eigen::Index>(receivers_.size());
    LuminaireColumn column{Eigen::VectorXd::Zero(rows), {}, Eigen::VectorXd::Zero(rows), 0};
    for (Eigen::Index row = 0; row < rows; ++row) {
      const Receiver& receiver = receivers_[static_cast<std::size_t>(row)];
      const double lux = unobstructed_lux(luminaire, luminaire.offset_world_m, receiver);
      if (!(lux > 0)) continue;
      if (visibility_.rays) {
        ++column.rays;
        if (rays_.occluded(receiver.position_world_m, receiver.normal_world, luminaire.offset_world_m)) continue;
      }
      column.direct_lux[row] = lux * rays_.transmittance(receiver.position_world_m, luminaire.offset_world_m);
    }
    column.total_lux = column.direct_lux;
    return column;
  }

  const Scene& scene_;
  const RayScene& rays_;
  std::vector<Receiver> receivers_;
  IncrementalOptions options_;
  std::unique_ptr<Blockers> blockers_;
  VisibilityScene visibility_{};
  std::unique_ptr<IndirectColumns> indirect_;
  std::uint64_t rays_cast_ = 0;
};

}  // namespace

Result<std::unique_ptr<IncrementalTransport>> IncrementalTransport::make(const Scene& scene, const RayScene& rays,
                                                                         std::span<const Receiver> receivers,
                                                                         const IncrementalOptions& options) {
  if (auto checked = check_evaluation(receivers, {}, {}); !checked) return tl::unexpected(std::move(checked.error()));
  if (options.cells == 0 || options.rays_per_cell < 3 || options.rays_per_column < 16)
    return refusal(fmt::format("{} cells, {} rays per cell and {} per column are too few; at least 1, 3 and 16",
                               options.cells, options.rays_per_cell, options.rays_per_column));
  auto made = std::make_unique<Incremental>(scene, rays, receivers, options);
  if (auto prepared = made->prepare(options); !prepared) return tl::unexpected(std::move(prepared.error()));
  return made;
}

}  // namespace luxrig
