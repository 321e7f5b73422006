#pragma once
/// Bytes from the wire to one request, within limits.

#include <cstddef>
#include <memory>
#include <string_view>

#include "tools/http/message.h"

namespace luxrig {

class RequestReader {
 public:
  enum class At {
    head,      ///< of the request line and headers more is wanted
    decision,  ///< the head is there; accept_body() or no more bytes
    body,      ///< of the body more is wanted
    whole,
    refused,  ///< see refusal(); what follows on the wire means nothing
  };

  RequestReader();
  ~RequestReader();

  /// Takes bytes; at `head` and `body` only.
  void put(std::string_view bytes);
  [[nodiscard]] At at() const { return at_; }
  /// Reads on, a body of at most so many bytes, also in chunks; refused at once when it says that it is longer.
  void accept_body(std::size_t max_bytes);

  [[nodiscard]] bool begun() const { return begun_; }
  [[nodiscard]] bool has_body() const;  ///< from `decision` on
  [[nodiscard]] bool keep_alive() const;
  /// Bytes came that are not of this request: once it is answered, the connection is to be closed.
  [[nodiscard]] bool more_came() const;
  [[nodiscard]] const HttpRequest& request() const { return request_; }
  [[nodiscard]] HttpRequest take() { return std::move(request_); }
  [[nodiscard]] const HttpResponse& refusal() const { return refusal_; }

 private:
  void refuse(int status, const char* what);
  void parse();
  void read_head();

  struct Parser;
  std::unique_ptr<Parser> parser_;
  At at_ = At::head;
  bool begun_ = false;
  HttpRequest request_;
  HttpResponse refusal_;
};

}  // namespace luxrig
