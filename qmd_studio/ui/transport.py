"""What the verbs of the Animate menu do to the playhead."""

from __future__ import annotations

from collections.abc import Callable

from qmd_studio.project.playhead import Playhead


def transport_handlers(playhead: Playhead) -> dict[str, Callable[[], None]]:
    """Return the handler of each transport verb, by its id."""

    def play(direction: int) -> None:
        if playhead.playing and playhead.speed * direction > 0:
            playhead.playing = False
            return
        playhead.speed = direction * abs(playhead.speed)
        playhead.playing = True

    def step(frames: int) -> Callable[[], None]:
        return lambda: playhead.step(frames)

    def step_second(direction: int) -> Callable[[], None]:
        return lambda: playhead.step(direction * max(round(playhead.fps), 1))

    def go(frame: Callable[[], int]) -> Callable[[], None]:
        return lambda: playhead.step(frame() - playhead.index)

    def change_speed(factor: float) -> Callable[[], None]:
        def change() -> None:
            playhead.speed = playhead.speed * factor

        return change

    def toggle_loop() -> None:
        playhead.loop = not playhead.loop

    def range_start() -> None:
        playhead.preview_range = (playhead.index, max(playhead.last, playhead.index))

    def range_end() -> None:
        playhead.preview_range = (min(playhead.first, playhead.index), playhead.index)

    def range_clear() -> None:
        playhead.preview_range = None

    return {
        "play": lambda: play(1),
        "play_reverse": lambda: play(-1),
        "previous_frame": step(-1),
        "next_frame": step(1),
        "back_second": step_second(-1),
        "on_second": step_second(1),
        "first_frame": go(lambda: playhead.first),
        "last_frame": go(lambda: playhead.last),
        "loop": toggle_loop,
        "range_start": range_start,
        "range_end": range_end,
        "range_clear": range_clear,
        "slower": change_speed(0.5),
        "faster": change_speed(2.0),
    }
