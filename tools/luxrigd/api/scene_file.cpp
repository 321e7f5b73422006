#include "tools/luxrigd/api/scene_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "core/fingerprint.h"
#include "core/scene/scene_glb.h"

namespace luxrig {
namespace {

std::string etag_of(const std::string& bytes) {
  Fingerprint print;
  print.add(std::uint64_t{bytes.size()});
  for (std::size_t at = 0; at < bytes.size(); at += sizeof(std::uint64_t)) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + at, std::min(sizeof word, bytes.size() - at));
    print.add(word);
  }
  return fmt::format("\"{:016x}\"", print.value());
}

/// If-None-Match (RFC 9110, 13.1.2): a list of tags, or *. A weak tag matches too.
bool has_it(const HttpRequest& request, const std::string& etag) {
  std::string_view tags = request.header("if-none-match").value_or("");
  while (!tags.empty()) {
    const std::size_t end = std::min(tags.find(','), tags.size());
    std::string_view tag = tags.substr(0, end);
    tags.remove_prefix(std::min(end + 1, tags.size()));
    while (!tag.empty() && (tag.front() == ' ' || tag.front() == '\t')) tag.remove_prefix(1);
    while (!tag.empty() && (tag.back() == ' ' || tag.back() == '\t')) tag.remove_suffix(1);
    if (tag.substr(0, 2) == "W/") tag.remove_prefix(2);
    if (tag == etag || tag == "*") return true;
  }
  return false;
}

}  // namespace

struct SceneFile::Made {
  std::string glb, etag;
};

SceneFile::SceneFile(SessionInForce session) : session_(std::move(session)) {}
SceneFile::~SceneFile() = default;

std::shared_ptr<const SceneFile::Made> SceneFile::made_for(const std::shared_ptr<const Session>& session) {
  const std::lock_guard lock(mutex_);  // a second request waits for the first one's work
  if (!made_ || of_.lock() != session) {
    Made made;
    made.glb = scene_glb(session->scene);
    made.etag = etag_of(made.glb);
    made_ = std::make_shared<const Made>(std::move(made));
    of_ = session;
  }
  return made_;
}

HttpResponse SceneFile::answer(const HttpRequest& request) {
  const auto session = session_ ? session_() : nullptr;
  if (!session || (session->scene.triangles.empty() && session->scene.panes.empty()))
    return http_refusal(404, "this rig has no scene");
  const auto made = made_for(session);
  if (made->glb.empty())
    return http_refusal(413, fmt::format("the scene has {} triangles: too many to show in a browser; the plan shows it",
                                         session->scene.triangles.size()));
  // Kept by the browser, but asked for again each time: a reload of the rig may bring another.
  HttpResponse response{200, "model/gltf-binary", {}, {{"ETag", made->etag}, {"Cache-Control", "private, no-cache"}}};
  if (has_it(request, made->etag))
    response.status = 304;
  else
    response.body = made->glb;
  return response;
}

}  // namespace luxrig
