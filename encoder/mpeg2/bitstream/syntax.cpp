#include "encoder/mpeg2/bitstream/syntax.h"

#include <cmath>

#include "encoder/mpeg2/bitstream/codes.h"
#include "encoder/timecode.h"

namespace render2mpeg::encoder {
namespace mpeg2 {
namespace {

// Start codes and extension identifiers. [H262, tables 6-1 and 6-2]
constexpr std::uint8_t picture_start = 0x00, first_slice_start = 0x01, sequence_start = 0xb3, extension_start = 0xb5,
                       user_data_start = 0xb2, sequence_end_code = 0xb7, gop_start = 0xb8;
constexpr std::uint32_t sequence_extension = 1, sequence_display_extension = 2, picture_coding_extension = 8;

constexpr std::uint32_t main_profile = 4;
constexpr std::uint32_t chroma_420 = 1;
constexpr std::uint32_t frame_structure = 3;
constexpr std::uint32_t variable_rate_delay = 0xffff;  // vbv_delay

std::uint32_t low_bits(std::int64_t value, int count) {
    return static_cast<std::uint32_t>(value & ((std::int64_t{1} << count) - 1));
}

/// The flag that says whether a matrix follows, and the matrix where it is not the default one.
void write_matrix(BitWriter& out, const Matrix& matrix, const Matrix& standard) {
    out.put(matrix == standard ? 0 : 1, 1);
    if (matrix == standard) return;
    for (const std::uint8_t raster : zigzag) out.put(matrix[raster], 8);
}

void write_sequence_header(BitWriter& out, const Settings& s, const Channel& channel, const Matrices& matrices) {
    out.start_code(sequence_start);
    out.put(low_bits(s.width, 12), 12);
    out.put(low_bits(s.height, 12), 12);
    out.put(static_cast<std::uint32_t>(s.aspect_ratio_code), 4);
    out.put(static_cast<std::uint32_t>(declared_rate(s).code), 4);
    out.put(low_bits(channel.bit_rate / 400, 18), 18);
    out.put(1, 1);  // marker
    out.put(low_bits(channel.buffer_bits / 16384, 10), 10);
    out.put(0, 1);  // constrained_parameters_flag
    write_matrix(out, matrices.intra, default_intra_matrix);
    write_matrix(out, matrices.non_intra, default_non_intra_matrix);
}

void write_sequence_extension(BitWriter& out, const Settings& s, const Level& level, const Channel& channel) {
    out.start_code(extension_start);
    out.put(sequence_extension, 4);
    out.put(main_profile << 4 | static_cast<std::uint32_t>(level.indication), 8);
    out.put(s.cadence == Cadence::frames ? 1 : 0, 1);  // progressive_sequence
    out.put(chroma_420, 2);
    out.put(low_bits(s.width >> 12, 2), 2);
    out.put(low_bits(s.height >> 12, 2), 2);
    out.put(low_bits((channel.bit_rate / 400) >> 18, 12), 12);
    out.put(1, 1);  // marker
    out.put(low_bits((channel.buffer_bits / 16384) >> 10, 8), 8);
    out.put(0, 1);  // low_delay
    out.put(0, 2);  // frame_rate_extension_n
    out.put(0, 5);  // frame_rate_extension_d
}

void write_sequence_display_extension(BitWriter& out, const Settings& s) {
    out.start_code(extension_start);
    out.put(sequence_display_extension, 4);
    out.put(5, 3);  // video_format: unspecified, the pictures never were a broadcast signal
    out.put(1, 1);  // colour_description
    // Primaries are BT.709's whatever the matrix: pictures are developed from radiance with BT.709 primaries.
    out.put(1, 8);
    out.put(static_cast<std::uint32_t>(s.transfer_characteristics), 8);
    out.put(static_cast<std::uint32_t>(s.matrix_coefficients), 8);
    out.put(low_bits(s.width, 14), 14);
    out.put(1, 1);  // marker
    out.put(low_bits(s.height, 14), 14);
    out.align();
}

}  // namespace

void write_sequence(BitWriter& out, const Settings& settings, const Level& level, const Matrices& matrices) {
    const Channel channel = channel_for(settings, level);
    write_sequence_header(out, settings, channel, matrices);
    write_sequence_extension(out, settings, level, channel);
    write_sequence_display_extension(out, settings);
    if (settings.user_data.empty()) return;
    out.start_code(user_data_start);
    for (const char c : settings.user_data) out.put(static_cast<std::uint8_t>(c), 8);
}

void write_gop(BitWriter& out, const Settings& settings, std::int64_t first_number, bool closed) {
    const std::int64_t per_second = std::llround(declared_rate(settings).hertz.value());
    const std::int64_t from = settings.labels.start ? settings.first_number : 0;
    const Timecode time = later(settings.labels.start.value_or(Timecode()),
                                fields_before(settings.cadence, first_number - from) / 2, static_cast<int>(per_second));
    out.start_code(gop_start);
    out.put(time.drops ? 1 : 0, 1);  // drop_frame_flag
    out.put(static_cast<std::uint32_t>(time.hours), 5);
    out.put(static_cast<std::uint32_t>(time.minutes), 6);
    out.put(1, 1);  // marker
    out.put(static_cast<std::uint32_t>(time.seconds), 6);
    out.put(static_cast<std::uint32_t>(time.frames), 6);
    out.put(closed ? 1 : 0, 1);  // closed_gop
    out.put(0, 1);               // broken_link
    out.align();
}

void write_picture_header(BitWriter& out, const PictureHeader& h) {
    out.start_code(picture_start);
    out.put(low_bits(h.temporal_reference, 10), 10);
    out.put(static_cast<std::uint32_t>(h.type), 3);
    out.put(variable_rate_delay, 16);
    if (h.type != PictureType::intra) {
        out.put(0, 1);  // full_pel_forward_vector, MPEG-1 only
        out.put(7, 3);  // forward_f_code, MPEG-1 only
    }
    if (h.type == PictureType::bidirectional) {
        out.put(0, 1);  // full_pel_backward_vector, MPEG-1 only
        out.put(7, 3);  // backward_f_code, MPEG-1 only
    }
    out.put(0, 1);  // extra_bit_picture
    out.start_code(extension_start);
    out.put(picture_coding_extension, 4);
    for (const auto& direction : h.f_code)
        for (const int f_code : direction) out.put(static_cast<std::uint32_t>(f_code), 4);
    out.put(static_cast<std::uint32_t>(h.intra_dc_bits - 8), 2);
    out.put(frame_structure, 2);
    out.put(h.shown.top_first ? 1 : 0, 1);  // top_field_first
    out.put(1, 1);                          // frame_pred_frame_dct
    out.put(0, 1);                          // concealment_motion_vectors
    out.put(0, 1);                          // q_scale_type: linear
    out.put(h.intra_vlc_format ? 1 : 0, 1);
    out.put(0, 1);                             // alternate_scan
    out.put(h.shown.repeat_first ? 1 : 0, 1);  // repeat_first_field
    out.put(1, 1);                             // chroma_420_type
    out.put(1, 1);                             // progressive_frame
    out.put(0, 1);                             // composite_display_flag
    out.align();
}

void set_vbv_delay(std::span<std::uint8_t> picture, int delay) {
    // It follows the start code, temporal_reference and picture_coding_type: 32 + 10 + 3 bits.
    constexpr std::size_t at = 5;
    const auto value = static_cast<unsigned>(delay);
    picture[at] = static_cast<std::uint8_t>((picture[at] & 0xf8) | value >> 13);
    picture[at + 1] = static_cast<std::uint8_t>(value >> 5);
    picture[at + 2] = static_cast<std::uint8_t>((picture[at + 2] & 0x07) | (value & 31) << 3);
}

void add_stuffing(std::vector<std::uint8_t>& picture, std::size_t count) {
    for (std::size_t at = 4; at + 3 < picture.size(); ++at)
        if (picture[at] == 0 && picture[at + 1] == 0 && picture[at + 2] == 1 && picture[at + 3] == first_slice_start) {
            picture.insert(picture.begin() + static_cast<std::ptrdiff_t>(at), count, std::uint8_t{0});
            return;
        }
}

void write_slice_header(BitWriter& out, int lines, int row, int quantiser) {
    // Rows beyond 175 share start codes, told apart by three more bits. [H262, 6.3.16]
    const bool tall = lines > 2800;
    out.start_code(static_cast<std::uint8_t>((tall ? row % 128 : row) + 1));
    if (tall) out.put(static_cast<std::uint32_t>(row / 128), 3);
    out.put(static_cast<std::uint32_t>(quantiser), 5);
    out.put(0, 1);  // extra_bit_slice
}

}  // namespace mpeg2

std::vector<std::uint8_t> sequence_end() {
    mpeg2::BitWriter out;
    out.start_code(mpeg2::sequence_end_code);
    return out.take();
}

}  // namespace render2mpeg::encoder
