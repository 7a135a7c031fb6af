"""The ASGI application of the hub: its operations, its feed and its page."""

from __future__ import annotations

from typing import TYPE_CHECKING

from starlette.applications import Starlette
from starlette.routing import WebSocketRoute

from passo.hub.call import HubCall, HubSite
from passo.hub.feed import FarmFeed
from passo.hub.operations import OPERATIONS
from passo.web import openapi
from passo.web.access import Access, Binding
from passo.web.guard import Guard
from passo.web.operation import API
from passo.web.pages import FARM, page_routes
from passo.web.routes import EXCEPTION_HANDLERS, routes

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.types import ASGIApp

    from passo.web.accounts.accounts import Accounts
    from passo.web.operation import Caller

TITLE = "Passo hub"


def hub_app(site: HubSite, accounts: Accounts, binding: Binding) -> ASGIApp:
    """The application of a farm at one address."""
    access = Access(accounts, binding)
    feed = FarmFeed(site.farm, site.limits, access)

    def call(caller: Caller, request: Request) -> HubCall:
        return HubCall(access, caller, request, site)

    app = Starlette(
        routes=[
            *routes(OPERATIONS, access, call),
            openapi.route(OPERATIONS, TITLE),
            WebSocketRoute(f"{API}/feed", feed.serve),
            *page_routes(page=FARM),
        ],
        exception_handlers=EXCEPTION_HANDLERS,
    )
    return Guard(app, binding)
