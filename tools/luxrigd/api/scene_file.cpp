#include "tools/luxrigd/api/scene_file.h"

#include <fmt/format.h>

#include "core/scene/scene_glb.h"

namespace luxrig {

SceneFile::SceneFile(SessionInForce session) : session_(std::move(session)) {}
SceneFile::~SceneFile() = default;

std::shared_ptr<const KeptAnswer> SceneFile::made_for(const std::shared_ptr<const Session>& session) {
  const std::lock_guard lock(mutex_);  // a second request waits for the first one's work
  if (!made_ || of_.lock() != session) {
    made_ = std::make_shared<const KeptAnswer>(kept_answer("model/gltf-binary", scene_glb(session->scene)));
    of_ = session;
  }
  return made_;
}

HttpResponse SceneFile::answer(const HttpRequest& request) {
  const auto session = session_ ? session_() : nullptr;
  if (!session || (session->scene.triangles.empty() && session->scene.panes.empty()))
    return http_refusal(404, "this rig has no scene");
  const auto made = made_for(session);
  if (made->empty())
    return http_refusal(413, fmt::format("the scene has {} triangles: too many to show in a browser; the plan shows it",
                                         session->scene.triangles.size()));
  return answer_with(*made, request);
}

}  // namespace luxrig
