#pragma once
// Embree 3 and 4 behind the same calls: what they differ in is said here and nowhere else.

// The build chooses, since both may be installed.
#if RENDER2MPEG_EMBREE >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace render2mpeg::renderer::embree {

#if RENDER2MPEG_EMBREE >= 4
using LibraryContext = RTCRayQueryContext;
constexpr RTCSceneFlags filters_of_contexts = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;
#else
using LibraryContext = RTCIntersectContext;
constexpr RTCSceneFlags filters_of_contexts = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;
#endif

/// Context handed to Embree beside the rays, and from there to filters.
struct Context {
    LibraryContext library;  ///< first, so that its pointer is ours; prepared by each call
    bool coherent = false;   ///< whether the rays of a packet go about the same way
    RTCFilterFunctionN filter =
        nullptr;  ///< called for every hit of any ray, beside the geometries' own; none: nullptr
};

/// The context of a call in which Embree calls a filter; `Ours` is or begins with Context.
template <class Ours>
Ours& context_of(const RTCFilterFunctionNArguments* arguments) {
    return *reinterpret_cast<Ours*>(arguments->context);
}

#if RENDER2MPEG_EMBREE >= 4
template <class Arguments>
Arguments prepared(Context& context, Arguments arguments) {
    rtcInitRayQueryContext(&context.library);
    const int flags = (context.coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT) |
                      (context.filter != nullptr ? RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER : 0);
    arguments.flags = static_cast<RTCRayQueryFlags>(flags);
    arguments.context = &context.library;
    arguments.filter = context.filter;
    return arguments;
}

inline RTCIntersectArguments for_nearest(Context& context) {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    return prepared(context, arguments);
}

inline RTCOccludedArguments for_any(Context& context) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    return prepared(context, arguments);
}

inline void intersect(RTCScene scene, Context& context, RTCRayHit& ray) {
    RTCIntersectArguments arguments = for_nearest(context);
    rtcIntersect1(scene, &ray, &arguments);
}

inline void intersect(const int* valid, RTCScene scene, Context& context, RTCRayHit16& rays) {
    RTCIntersectArguments arguments = for_nearest(context);
    rtcIntersect16(valid, scene, &rays, &arguments);
}

inline void occluded(RTCScene scene, Context& context, RTCRay& ray) {
    RTCOccludedArguments arguments = for_any(context);
    rtcOccluded1(scene, &ray, &arguments);
}

/// Takes room for hits: without AVX-512, Embree 4.3 reads and writes it for occluded packets as well.
inline void occluded(const int* valid, RTCScene scene, Context& context, RTCRayHit16& rays) {
    RTCOccludedArguments arguments = for_any(context);
    rtcOccluded16(valid, scene, &rays.ray, &arguments);
}
#else
inline RTCIntersectContext* prepared(Context& context) {
    rtcInitIntersectContext(&context.library);
    context.library.flags =
        context.coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    context.library.filter = context.filter;
    return &context.library;
}

inline void intersect(RTCScene scene, Context& context, RTCRayHit& ray) {
    rtcIntersect1(scene, prepared(context), &ray);
}

inline void intersect(const int* valid, RTCScene scene, Context& context, RTCRayHit16& rays) {
    rtcIntersect16(valid, scene, prepared(context), &rays);
}

inline void occluded(RTCScene scene, Context& context, RTCRay& ray) {
    rtcOccluded1(scene, prepared(context), &ray);
}

inline void occluded(const int* valid, RTCScene scene, Context& context, RTCRayHit16& rays) {
    rtcOccluded16(valid, scene, prepared(context), &rays.ray);
}
#endif

}  // namespace render2mpeg::renderer::embree
