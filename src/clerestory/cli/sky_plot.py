"""`clerestory sky plot`: annual heat maps, and false-colour images of skies."""

from clerestory.cli.requests.sky import WeatherPlot
from clerestory.cli.sky import selected_weather
from clerestory.report.figure_file import write_figure
from clerestory.report.sky_plots import dome_figure, year_figure


def plot(request: WeatherPlot) -> None:
    """Plot annual maps of irradiance, or the sky luminance of one time step."""
    data = selected_weather(request.weather, request.days, request.time)
    figure = year_figure(data) if request.time is None else dome_figure(data)
    write_figure(figure, request.output)
