#pragma once
/// From bytes on the wire to one request, within limits.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>

#include "tools/http/message.h"

namespace luxrig {

class RequestReader {
 public:
  enum class At {
    head,      ///< more of the request line and headers is needed
    decision,  ///< the head is complete: call accept_body(), or put no more bytes
    body,      ///< more of the body is needed
    whole,
    refused,  ///< see refusal(); later bytes on the wire mean nothing
  };

  RequestReader();
  ~RequestReader();

  /// Takes bytes; at `head` and `body` only.
  void put(std::string_view bytes);
  [[nodiscard]] At at() const { return at_; }
  /// Goes on to read a body of at most this many bytes, chunked or not. Refuses at once if its stated length is longer.
  void accept_body(std::size_t max_bytes);

  [[nodiscard]] bool begun() const { return begun_; }
  [[nodiscard]] bool has_body() const;  ///< from `decision` on
  /// Its stated length, from `decision` on; in chunks it may be any.
  [[nodiscard]] std::uint64_t longest_body_bytes() const;
  [[nodiscard]] bool keep_alive() const;
  /// There were bytes beyond this request: close the connection after the answer.
  [[nodiscard]] bool more_came() const;
  [[nodiscard]] const HttpRequest& request() const { return request_; }
  [[nodiscard]] HttpRequest& request() { return request_; }
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
