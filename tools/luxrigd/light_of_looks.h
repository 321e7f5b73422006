#pragma once
/// The light of a rig in the looks that its daemon is asked for. A known look is not computed again. When heads
/// turn, only their light is computed. The last look's light is saved, so that the next daemon has light at once.

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "core/tasks/light.h"
#include "core/tasks/session.h"
#include "tools/luxrigd/state/light_store.h"

namespace luxrig {

/// All functions may be called from any thread.
class LightOfLooks {
 public:
  /// folder   where the last light is saved; none: nowhere
  explicit LightOfLooks(ComputeOptions compute, std::optional<std::filesystem::path> folder = {})
      : compute_(std::move(compute)), folder_(std::move(folder)) {}

  /// Knows the light that an earlier daemon saved, and returns it. nullopt: none was saved of this rig with these
  /// options.
  std::optional<KeptLight> read_saved(const Session& session);

  /// Knows this light from now on.
  /// joints   per fixture: the aims that it was computed for
  void know(const Session& session, const std::vector<Joints>& joints, TransportMatrix transport);

  /// Light with heads at these joints, computed if it is not known, and saved. The computing thread has low priority.
  [[nodiscard]] Result<LightModel> model(const Session& session, const std::vector<Joints>& joints);

 private:
  struct Known {
    std::uint64_t key = 0;  ///< light_key
    KeptLight light;
    std::optional<TransportMatrix> transport;  ///< none: it was read from a file, which has only the model
  };
  std::shared_ptr<const Known> put(Known known);
  std::shared_ptr<const Known> put(std::uint64_t key, const Session& session, const std::vector<Joints>& joints,
                                   TransportMatrix transport);
  /// The known light of this key with the most fixtures aimed as asked; nullptr if there is none.
  void save(const std::shared_ptr<const Known>& known);
  [[nodiscard]] std::shared_ptr<const Known> nearest(std::uint64_t key, const std::vector<Joints>& joints,
                                                     bool with_transport) const;

  ComputeOptions compute_;
  std::optional<std::filesystem::path> folder_;
  mutable std::mutex mutex_;                         ///< guards what follows
  std::vector<std::shared_ptr<const Known>> known_;  ///< newest last
  std::shared_ptr<const Known> saved_;               ///< the light in the folder
};

}  // namespace luxrig
