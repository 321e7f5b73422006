#include "tools/luxrigd/api/rig_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/picture/pfm.h"
#include "core/picture/rig_camera.h"
#include "core/tasks/relief_task.h"
#include "tools/http/client.h"
#include "tools/terminal/picture_png.h"

namespace luxrig {
namespace {

constexpr int kWait_s = 180;

std::string in_url(const std::string& text) {
  std::string out;
  for (const unsigned char c : text)
    out += std::isalnum(c) ? std::string(1, static_cast<char>(c)) : fmt::format("%{:02X}", c);
  return out;
}

}  // namespace

Result<std::vector<TakenByCamera>> RigPictures::take(const std::string& label) {
  const Rig& rig = session_.rig;
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  const auto aim =
      std::find_if(rig.tasks.begin(), rig.tasks.end(), [](const Task& task) { return task.kind == TaskKind::aim; });
  if (aim != rig.tasks.end() && !std::exchange(studied_, true)) {
    const auto object = study_object(session_, aim->aim.relief, {});
    if (!object) return tl::unexpected(object.error());
    relief_ = object->study.points;
    scale_m_ = object->study.scale_m;
  }
  std::vector<TakenByCamera> all;
  for (const PictureCamera& camera : rig.cameras) {
    const auto answer = http_get({control_.host, control_.port}, "/picture?camera=" + in_url(camera.name), kWait_s);
    if (!answer) return refusal(fmt::format("camera \"{}\" gives no picture", camera.name));
    if (answer->status != 200) return refusal(fmt::format("camera \"{}\": {}", camera.name, answer->body));
    const auto picture = picture_from_pfm(answer->body);
    if (!picture) return refusal(fmt::format("camera \"{}\": {}", camera.name, picture.error().detail));
    if (picture->width_px != camera.width_px || picture->height_px != camera.height_px)
      return refusal(fmt::format("camera \"{}\": its picture has {} x {} pixels", camera.name, picture->width_px,
                                 picture->height_px));
    TakenByCamera taken{camera.name, folder_ / fmt::format("{}-{}.png", camera.name, label), {}};
    PhotographLook look;
    look.white_cd_m2 = metered_white_cd_m2(*picture);
    if (const std::string trouble = write_photograph(*picture, "", look, taken.file); !trouble.empty())
      return refusal(fmt::format("{} is not written: {}", taken.file.string(), trouble));
    if (!relief_.empty())
      taken.contrast = picture_contrast(*picture, view_of(camera), *session_.rays, relief_, scale_m_);
    all.push_back(std::move(taken));
  }
  return all;
}

}  // namespace luxrig
