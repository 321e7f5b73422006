#pragma once
/// An answer that stays the same for long: made once, compressed once, and sent only to who does not have it.

#include <string>

#include "tools/http/message.h"

namespace luxrig {

struct KeptAnswer {
  std::string content_type, body;
  std::string gzip;  ///< the body in gzip form
  std::string etag;  ///< of these bytes, in hex; the same bytes have the same one in every process

  [[nodiscard]] bool empty() const { return body.empty(); }
};

[[nodiscard]] KeptAnswer kept_answer(std::string content_type, std::string body);

/// 304 if the request has it (If-None-Match), else 200; as gzip if the request takes that. Caches keep it, and ask each
/// time. Strong ETags: each form has its own.
[[nodiscard]] HttpResponse answer_with(const KeptAnswer& kept, const HttpRequest& request);

}  // namespace luxrig
