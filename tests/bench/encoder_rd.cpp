// Rate against quality of our encoder and of libavcodec's (constant quantiser, the same GOPs), over four quantisers:
// prints the points and the Bjontegaard difference of rate (piecewise cubic, PSNR of luma; negative: fewer bits than
// libavcodec).
//
//   bench_encoder_rd [width height count]

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/opt.h>
}

#include "bd_rate.h"
#include "encoder/encoder.h"
#include "encoder_clip.h"
#include "parallel/loops.h"

namespace render2mpeg::bench {
namespace {

double squared_error(const core::Plane<std::uint8_t>& a, const std::uint8_t* b, int stride) {
    double sum = 0;
    for (int y = 0; y < a.height(); ++y)
        for (int x = 0; x < a.width(); ++x) {
            const double d = static_cast<double>(a.at(x, y)) - b[static_cast<std::ptrdiff_t>(y) * stride + x];
            sum += d * d;
        }
    return sum / static_cast<double>(a.size());
}

double psnr(double mean_squared_error) {
    return 10 * std::log10(255.0 * 255.0 / mean_squared_error);
}

RatePoint ours(const Clip& clip, int quantiser, int gop, int b_pictures, encoder::Effort effort, bool use_motion) {
    encoder::Settings s;
    s.width = clip.pictures[0].width();
    s.height = clip.pictures[0].height();
    s.rate = core::frame_rate_from("30");
    s.quantiser = quantiser;
    s.gop = gop;
    s.b_pictures = b_pictures;
    s.effort = effort;
    encoder::Encoder encoder(s);
    RatePoint point;
    double error = 0;
    std::uint64_t evaluations = 0, macroblocks = 0;
    std::vector<std::uint8_t> stream;
    const auto take = [&](const std::vector<encoder::CodedPicture>& pictures) {
        for (const encoder::CodedPicture& coded : pictures) {
            point.bits += 8.0 * static_cast<double>(coded.bytes.size());
            error += squared_error(clip.pictures[static_cast<std::size_t>(coded.plan.number)].y,
                                   coded.reconstruction.y.row(0), s.width);
            evaluations += coded.block_evaluations;
            if (!coded.plan.references.empty()) macroblocks += coded.macroblocks.size();
            stream.insert(stream.end(), coded.bytes.begin(), coded.bytes.end());
        }
    };
    std::clock_t spent = 0;
    const auto count = static_cast<std::int64_t>(clip.pictures.size());
    for (std::int64_t n = 0; n < count; ++n) {
        const encoder::PicturePlan plan = encoder.plan(n, {.frames_left = count - 1 - n}, n == 0);
        std::vector<core::MotionField> motion;
        for (const std::int64_t reference : plan.references)
            if (use_motion) motion.push_back(clip.motion(n, reference));
        const std::clock_t begin = std::clock();
        const std::vector<encoder::CodedPicture> coded =
            encoder.push(clip.pictures[static_cast<std::size_t>(n)], plan, motion);
        spent += std::clock() - begin;
        take(coded);
    }
    take(encoder.flush());
    const double seconds = static_cast<double>(spent) / CLOCKS_PER_SEC;
    point.psnr = psnr(error / static_cast<double>(clip.pictures.size()));
    std::printf("ours%-10s%s q %2d  %9.0f bits/picture  %.3f dB  %5.1f pictures/CPU s  %.1f evaluations/macroblock\n",
                use_motion ? "" : " no motion", effort == encoder::Effort::fast ? " fast" : "", quantiser,
                point.bits / static_cast<double>(clip.pictures.size()), point.psnr,
                static_cast<double>(clip.pictures.size()) / seconds,
                macroblocks ? static_cast<double>(evaluations) / static_cast<double>(macroblocks) : 0.0);
    const std::vector<std::uint8_t> end = encoder::sequence_end();
    stream.insert(stream.end(), end.begin(), end.end());
    if (const char* directory = std::getenv("ENCODER_RD_STREAMS"))
        std::ofstream(std::string(directory) + "/ours_q" + std::to_string(quantiser) + ".m2v", std::ios::binary)
            .write(reinterpret_cast<const char*>(stream.data()), static_cast<std::streamsize>(stream.size()));
    return point;
}

/// What libavcodec's decoder shows, so that its encoder is measured like ours.
void collect(AVCodecContext* decoder, const Clip& clip, std::size_t& shown, double& error) {
    AVFrame* frame = av_frame_alloc();
    while (avcodec_receive_frame(decoder, frame) == 0 && shown < clip.pictures.size())
        error += squared_error(clip.pictures[shown++].y, frame->data[0], frame->linesize[0]);
    av_frame_free(&frame);
}

AVCodecContext* open_encoder(int width, int height, int gop, int b_pictures, int quantiser, bool strong) {
    AVCodecContext* encoder = avcodec_alloc_context3(avcodec_find_encoder(AV_CODEC_ID_MPEG2VIDEO));
    encoder->width = width;
    encoder->height = height;
    encoder->pix_fmt = AV_PIX_FMT_YUV420P;
    encoder->time_base = {1, 30};
    encoder->framerate = {30, 1};
    encoder->gop_size = gop;
    encoder->max_b_frames = b_pictures;
    encoder->thread_count = 1;
    encoder->bit_rate = 400'000'000;
    if (!strong) encoder->flags |= AV_CODEC_FLAG_QSCALE;
    if (strong) {
        // The quantiser follows from a Lagrangian that is the same for all pictures but for these factors.
        encoder->qmin = 1;
        encoder->qmax = 31;
        encoder->qcompress = 0.6f;
        encoder->i_quant_factor = 0.8f;
        encoder->i_quant_offset = 0.0f;
        encoder->b_quant_factor = 1.5f;
        encoder->b_quant_offset = 0.0f;
        av_opt_set_int(encoder, "lmin", FF_QP2LAMBDA * quantiser, AV_OPT_SEARCH_CHILDREN);
        av_opt_set_int(encoder, "lmax", FF_QP2LAMBDA * quantiser, AV_OPT_SEARCH_CHILDREN);
        encoder->mb_decision = FF_MB_DECISION_RD;
        encoder->trellis = 2;
        av_opt_set(encoder, "mpv_flags", "+skip_rd+mv0", AV_OPT_SEARCH_CHILDREN);
        encoder->mb_cmp = FF_CMP_RD;
        encoder->me_sub_cmp = FF_CMP_SATD;
        encoder->dia_size = 770;
        encoder->pre_dia_size = 4;
        av_opt_set_int(encoder, "mepre", 2, AV_OPT_SEARCH_CHILDREN);
        encoder->last_predictor_count = 3;
    }
    avcodec_open2(encoder, nullptr, nullptr);
    return encoder;
}

AVFrame* to_frame(const core::Picture& p, int quantiser) {
    AVFrame* frame = av_frame_alloc();
    frame->format = AV_PIX_FMT_YUV420P;
    frame->width = p.width();
    frame->height = p.height();
    av_frame_get_buffer(frame, 0);
    for (int plane = 0; plane < 3; ++plane) {
        const core::Plane<std::uint8_t>& from = plane == 0 ? p.y : plane == 1 ? p.cb : p.cr;
        for (int y = 0; y < from.height(); ++y)
            std::copy_n(from.row(y), from.width(),
                        frame->data[plane] + static_cast<std::ptrdiff_t>(y) * frame->linesize[plane]);
    }
    frame->pts = p.number;
    frame->quality = FF_QP2LAMBDA * quantiser;
    return frame;
}

/// `strong`: mode decision by rate and distortion, trellis quantisation and a wide motion search.
RatePoint libavcodec(const Clip& clip, int quantiser, int gop, int b_pictures, bool strong) {
    AVCodecContext* encoder =
        open_encoder(clip.pictures[0].width(), clip.pictures[0].height(), gop, b_pictures, quantiser, strong);
    AVCodecContext* decoder = avcodec_alloc_context3(avcodec_find_decoder(AV_CODEC_ID_MPEG2VIDEO));
    avcodec_open2(decoder, nullptr, nullptr);

    RatePoint point;
    double error = 0;
    std::size_t shown = 0;
    std::clock_t spent = 0;
    AVPacket* packet = av_packet_alloc();
    for (std::size_t n = 0; n <= clip.pictures.size(); ++n) {
        // After the last picture, null drains the encoder.
        AVFrame* frame = n < clip.pictures.size() ? to_frame(clip.pictures[n], quantiser) : nullptr;
        std::clock_t begin = std::clock();
        avcodec_send_frame(encoder, frame);
        while (avcodec_receive_packet(encoder, packet) >= 0) {
            spent += std::clock() - begin;
            point.bits += 8.0 * packet->size;
            avcodec_send_packet(decoder, packet);
            collect(decoder, clip, shown, error);
            av_packet_unref(packet);
            begin = std::clock();
        }
        spent += std::clock() - begin;
        av_frame_free(&frame);
    }
    avcodec_send_packet(decoder, nullptr);
    collect(decoder, clip, shown, error);
    av_packet_free(&packet);
    avcodec_free_context(&encoder);
    avcodec_free_context(&decoder);
    point.psnr = psnr(error / static_cast<double>(clip.pictures.size()));
    std::printf("libavcodec%-4s q %2d  %9.0f bits/picture  %.3f dB  %5.1f pictures/CPU s\n", strong ? " +" : "",
                quantiser, point.bits / static_cast<double>(clip.pictures.size()), point.psnr,
                static_cast<double>(clip.pictures.size()) * CLOCKS_PER_SEC / static_cast<double>(spent));
    return point;
}

}  // namespace
}  // namespace render2mpeg::bench

int main(int argc, char** argv) {
    using namespace render2mpeg;
    const bool sized = argc > 3;
    const int width = sized ? std::atoi(argv[1]) : 1280, height = sized ? std::atoi(argv[2]) : 720,
              count = sized ? std::atoi(argv[3]) : 30;
    const parallel::ThreadLimit limit(std::getenv("ENCODER_RD_THREADS") ? std::atoi(std::getenv("ENCODER_RD_THREADS"))
                                                                        : 1);
    const bool only_ours = std::getenv("ENCODER_RD_ONLY_OURS") != nullptr;
    const int b_pictures = std::getenv("ENCODER_RD_B") ? std::atoi(std::getenv("ENCODER_RD_B")) : 2;
    for (const float speed : {1.0f, 3.0f}) {
        std::printf("clip: speed %g, %dx%d, %d pictures, GOP 15, %d B pictures\n", static_cast<double>(speed), width,
                    height, count, b_pictures);
        const bench::Clip clip(width, height, count, speed);
        std::vector<bench::RatePoint> with, without, simple, fast, plain, strong;
        for (const int q : {2, 4, 8, 16}) {
            with.push_back(bench::ours(clip, q, 15, b_pictures, encoder::Effort::quality, true));
            simple.push_back(bench::ours(clip, q, 15, 0, encoder::Effort::quality, true));
            fast.push_back(bench::ours(clip, q, 15, b_pictures, encoder::Effort::fast, true));
            if (only_ours) continue;
            without.push_back(bench::ours(clip, q, 15, b_pictures, encoder::Effort::quality, false));
            plain.push_back(bench::libavcodec(clip, q, 15, 2, false));
            strong.push_back(bench::libavcodec(clip, q, 15, 2, true));
        }
        std::printf("BD-rate against our own, fast:                       %+.2f %%\n", bench::bd_rate(fast, with));
        std::printf("BD-rate against our own without B pictures:          %+.2f %%\n", bench::bd_rate(simple, with));
        if (only_ours) continue;
        std::printf("BD-rate against libavcodec -bf 2:                    %+.2f %%, without motion %+.2f %%\n",
                    bench::bd_rate(plain, with), bench::bd_rate(plain, without));
        std::printf("BD-rate against libavcodec -bf 2, rd, trellis, umh:  %+.2f %%, without motion %+.2f %%\n",
                    bench::bd_rate(strong, with), bench::bd_rate(strong, without));
    }
    return 0;
}
