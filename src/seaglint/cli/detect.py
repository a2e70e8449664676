"""``seaglint detect``: probabilities of detection and false alarm of a detector, on a recording or in rendered scenes."""

from __future__ import annotations

from seaglint.cli.detect_options import DetectOptions, with_options


@with_options
def detect(options: DetectOptions) -> None:
    """Probabilities of detection and false alarm of a detector.

    With errors of place, of objects injected into a recording or into rendered scenes.
    """
    if options.of_scenario:
        from seaglint.cli.detect_scene import detect_scene

        detect_scene(options)
    else:
        from seaglint.cli.detect_recording import detect_recording

        detect_recording(options)
