// Python interface of frames and of the messages in them.
#include <nanobind/nanobind.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <stdexcept>

#include "bind/bind_bytes.hpp"
#include "sim/board_protocol.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;
using namespace passo::wire;

namespace {

FormatList declarations(const Declaration* begin, const Declaration* end) {
  FormatList list;
  for (; begin != end; ++begin) list.emplace_back(begin->id, begin->text);
  return list;
}

nb::bytes vlq(int64_t value) {
  uint8_t plain[kVlqMax], any[kVlqRoom];
  uint8_t *end = put_vlq(plain, uint32_t(value)), *same = put_vlq_any(any, uint32_t(value));
  if (!std::equal(plain, end, any, same)) throw std::logic_error("two encodings of one integer");
  return to_bytes(plain, size_t(end - plain));
}
std::pair<int64_t, size_t> read_vlq(const nb::bytes& data) {
  Reader in{data_of(data), data_of(data) + data.size()};
  uint32_t value = in.vlq();
  if (!in.ok) throw nb::value_error("no complete variable length quantity");
  return {int64_t(int32_t(value)), size_t(in.p - data_of(data))};
}
nb::bytes make_frame(const nb::bytes& payload, uint64_t sequence) {
  if (payload.size() > kPayloadMax) throw nb::value_error("a payload has at most 59 bytes");
  Bytes out;
  append_frame(out, data_of(payload), payload.size(), sequence);
  return to_bytes(out.data(), out.size());
}
nb::list scan(Scanner& scanner, const nb::bytes& data) {
  nb::list frames;
  scanner.feed(
      data_of(data), data.size(),
      [&](uint8_t sequence, const uint8_t* payload, size_t size) {
        frames.append(nb::make_tuple(int(sequence), to_bytes(payload, size)));
      },
      [&] { frames.append(nb::none()); });
  return frames;
}
nb::list decode_payload(const Formats& formats, const nb::bytes& payload) {
  nb::list messages;
  Reader in{data_of(payload), data_of(payload) + payload.size()};
  while (in.more()) {
    const Format* format = formats.find(int32_t(in.vlq()));
    if (!format) throw nb::value_error("unknown message id");
    std::vector<Value> values;
    format->decode(in, values);
    if (!in.ok) throw nb::value_error("message cut short");
    messages.append(nb::make_tuple(format->name, to_dict(*format, values)));
  }
  return messages;
}

}  // namespace

void bind_frames(nb::module_& m) {
  m.def(
      "crc16", [](const nb::bytes& data) { return Crc16::of(data_of(data), data.size()); },
      "data"_a, "CRC-16/MCRF4XX of the bytes.");
  m.def("encode_vlq", &vlq, "value"_a, "Encodes a 32-bit value (modulo 2^32) in 1 to 5 bytes.");
  m.def("decode_vlq", &read_vlq, "data"_a,
        "Returns (signed value, bytes used). ValueError if cut short.");
  m.def("make_frame", &make_frame, "payload"_a, "sequence"_a);
  m.def("board_commands", [] { return declarations(std::begin(kCommands), std::end(kCommands)); });
  m.def("board_reports", [] { return declarations(std::begin(kReports), std::end(kReports)); });
  m.def(
      "board_faults",
      [] { return std::vector<std::string>(std::begin(kFaults), std::end(kFaults)); },
      "Texts of the virtual board's shutdown reasons, by static_string_id.");
  nb::class_<Scanner>(m, "FrameScanner",
                      "Finds frames in a stream of bytes that may be split anywhere.")
      .def(nb::init<>())
      .def("feed", &scan, "data"_a,
           nb::sig("def feed(self, data: bytes) -> list[tuple[int, bytes] | None]"),
           "List with (sequence, payload) for each valid frame and None for each run of bytes that "
           "is not a frame.");
  nb::class_<Formats>(m, "Formats",
                      "Messages of one direction, as a data dictionary declares them.")
      .def(
          "__init__",
          [](Formats* self, const FormatList& list) { new (self) Formats(make_formats(list)); },
          "formats"_a)
      .def(
          "parameters",
          [](const Formats& f, const std::string& name) {
            std::vector<std::pair<std::string, bool>> list;
            for (const Parameter& p : f.at(name).parameters)
              list.emplace_back(p.name, p.type == Type::blob);
            return list;
          },
          "name"_a, "List of (parameter, is a blob). ValueError for an unknown message.")
      .def("names",
           [](const Formats& f) {
             std::vector<std::string> names;
             for (const Format& format : f.all()) names.push_back(format.name);
             return names;
           })
      .def(
          "encode",
          [](const Formats& f, const std::string& name, const nb::list& values) {
            Bytes out;
            f.at(name).encode(to_values(values), out);
            return to_bytes(out.data(), out.size());
          },
          "name"_a, "values"_a,
          nb::sig("def encode(self, name: str, values: list[int | bytes]) -> bytes"))
      .def("decode", &decode_payload, "payload"_a,
           nb::sig("def decode(self, payload: bytes) -> list[tuple[str, dict[str, int | bytes]]]"),
           "List of (name, values) of a frame's payload. ValueError if it is malformed.");
}
